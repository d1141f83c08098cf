#!/usr/bin/env bash
# Long fuzzing by libFuzzer under both sanitizers: ./deploy/fuzz.sh [--no-install] [--runs N | --seconds N] [TARGET...]
#   --runs N      inputs for every target (default 1000000)
#   --seconds N   instead: so long for every target
#   TARGET        envelope pairing color h264 depth frame_stream trace settings side_file field gltf parcel mesh_file; default all
# Inputs that led somewhere new are kept in build/fuzz/corpus/TARGET; one that fails lies beside them. A failing
# input that is mended belongs into tests/fuzz/corpus/TARGET: every test run tries it again.
source "$(dirname "$0")/common.sh"

install=yes limit=-runs=1000000 targets=()
while [ $# -gt 0 ]; do
  case $1 in
    --no-install) install=no ;;
    --runs) limit=-runs=${2:?--runs needs a number}; shift ;;
    --seconds) limit=-max_total_time=${2:?--seconds needs a number}; shift ;;
    -h | --help) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "deploy/fuzz.sh: unknown option '$1' (known: --no-install, --runs, --seconds)" >&2; exit 2 ;;
    *) targets+=("$1") ;;
  esac
  shift
done
if [ "${#targets[@]}" -eq 0 ]; then
  targets=(envelope pairing color h264 depth frame_stream trace settings side_file field gltf parcel mesh_file)
fi
if [ "$install" = yes ]; then "$root/deploy/install.sh" build test fuzz; fi

configure fuzz
cmake --build --preset fuzz --target "${targets[@]/#/fuzz_}"
# Refusing what is too large is part of what is tried, so allocation may fail; a hang is 10 s, memory 1 GB.
export ASAN_OPTIONS=allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/$target
  mkdir -p "$corpus"
  build/fuzz/bin/fuzz_"$target" --write-seeds "$corpus"
  known=tests/fuzz/corpus/$target
  [ -d "$known" ] || known=
  echo "== $target"
  build/fuzz/bin/fuzz_"$target" "$limit" -timeout=10 -rss_limit_mb=1024 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="$corpus/failed-" "$corpus" $known 2>&1 | grep -vE '^#|NEW|REDUCE|INFO|pulse' || exit 1
done
