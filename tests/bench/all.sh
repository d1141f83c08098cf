#!/usr/bin/env bash
# Every curve and the page, from nothing: tests/bench/all.sh [--quick] [FOLDER]
# Runs the experiments of build/release/bin/macula-bench one after the other (MACULA_BENCH names
# another program) and makes FOLDER/report.html (bench-out) of what they leave behind. Interrupted, it goes on
# where it was: an experiment whose report is there is not run again, tradeoff keeps its rows.
set -euo pipefail
quick=()
if [ "${1:-}" = --quick ]; then
  quick=(--quick)
  shift
fi
out=${1:-bench-out}
bench=${MACULA_BENCH:-$(dirname "$0")/../../build/release/bin/macula-bench}
[ -x "$bench" ] || {
  echo "all.sh: no $bench: cmake --preset release && ninja -C build/release macula_bench" >&2
  exit 2
}
mkdir -p "$out"

# measure NAME EXPERIMENT [option...]: OUT/NAME.json, unless it is there
measure() {
  local name=$1
  [ -f "$out/$name.json" ] && return
  echo "== macula-bench ${*:2}" >&2
  local pace=("${quick[@]}")
  [ "$2" = codecs ] && pace=()  # has one size
  "$bench" "${@:2}" "${pace[@]}" --json "$out/$name.json.part" >"$out/$name.txt"
  mv "$out/$name.json.part" "$out/$name.json"
}

echo "== macula-bench tradeoff" >&2
"$bench" tradeoff "${quick[@]}" --pictures "$out/pictures" --ladders "$out/ladders" \
  --json "$out/tradeoff.json" >"$out/tradeoff.txt"
measure ray ray --scene atrium
measure lightcuts lightcuts --scene room
measure culling culling
measure sphere sphere
measure maps maps
measure codecs codecs --frames 16
measure reprojection reprojection
measure streaming streaming
"$bench" report "$out" --out "$out/report.html"
