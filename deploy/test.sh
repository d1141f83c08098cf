#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: ./deploy/test.sh [--no-install] [--full] [--fast]
#   --no-install  take the machine as it is (no apt)
#   --fast        release build and its tests only; no sanitizers, no partial builds
#   --full        adds the long runs (sanitizers over every test, repeated loopback)
source "$(dirname "$0")/common.sh"

install=yes depth=normal
for argument in "$@"; do
  case $argument in
    --no-install) install=no ;;
    --fast) depth=fast ;;
    --full) depth=full ;;
    -h | --help) sed -n '2,6s/^# //p' "$0"; exit 0 ;;
    *) echo "deploy/test.sh: unknown option '$argument' (known: --no-install, --fast, --full)" >&2; exit 2 ;;
  esac
done
if [ "$install" = yes ]; then
  "$root/deploy/install.sh" build test
  "$root/tests/support/monado/monado.sh" prepare "$root/build/monado" ||
    echo "deploy/test.sh: Monado could not be fetched; its tests will be skipped" >&2
fi

say() { printf '\n== %s (%s)\n' "$*" "$(date -u +%H:%M:%S)"; }
# run_ctest PRESET LABEL_TO_SKIP [ctest options...]. Tests over real sockets and displays share the machine
# with its neighbours, and leak checks with the threads of GL: three tries. Everything else has one.
runner=()
say_openxr() {  # how many tests of a headset ran and were skipped, and why
  local ran skipped
  ran=$(grep -cE '^\[       OK \] (Headset|Monado)' "$1" || true)
  skipped=$(grep -cE '^\[  SKIPPED \] (Headset|Monado)[A-Za-z]*\.[A-Za-z]+ \(' "$1" || true)
  echo "OpenXR: $ran tests ran, $skipped were skipped"
  grep -A1 -E '^[^ ]*(headset|monado)[^ ]*_test\.cpp:[0-9]+: Skipped' "$1" | grep -vE 'Skipped|^--' | sort -u || true
}
run_ctest() {
  local preset=$1 skip=$2
  shift 2
  local ctest=("${runner[@]}" ctest --test-dir "build/$preset" --output-on-failure --no-tests=error -j2 "$@")
  "${ctest[@]}" -LE "^(loopback|window${skip:+|$skip})\$"
  "${ctest[@]}" -L '^(loopback|window)$' --repeat until-pass:3
  say_openxr "build/$preset/Testing/Temporary/LastTest.log"
}

say_faults() {  # what was tried against the programs, and the figures
  local table=$1/fault_table.tsv
  [ -s "$table" ] || return 0
  printf '\nFaults, what is asked, and what was measured (a test tried again has a row for each try):\n'
  sort -u "$table" | awk -F'\t' '{ printf "%-42s | %-58s | %s\n", $1, $2, $3 }'
}

say "release build, warnings are errors"
configure_and_build release
say "every test"
rm -f build/release/fault_table.tsv
run_ctest release ""
say_faults build/release
[ "$depth" = fast ] && exit 0

# Sanitizers watch the code, not its figures: long renderings and measured times stay out unless --full.
skip=slow unmeasured=(-E FindsThirtyMilliseconds) pictures=OFF
[ "$depth" = full ] && skip="" unmeasured=() pictures=ON

say "address and undefined-behaviour sanitizers"
configure_and_build asan -DMACULA_SANITIZE_PICTURES=$pictures
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
run_ctest asan "$skip" "${unmeasured[@]}"

say "thread sanitizer"
configure_and_build tsan
export TSAN_OPTIONS="suppressions=$root/tests/support/tsan.supp halt_on_error=1 second_deadlock_stack=1"
runner=(setarch -R)
run_ctest tsan "$skip" "${unmeasured[@]}"

say "server alone, client alone"
configure_and_build server-only
configure_and_build client-only
"$root/deploy/check_links.sh"
