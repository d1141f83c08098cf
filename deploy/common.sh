# Sourced by demo.sh and test.sh: where we are, how we build.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

# ccache finds a fresh clone's objects only when paths are relative to its root.
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1

configure_and_build() {  # configure_and_build PRESET [TARGET...]
  local preset=$1
  shift
  local launcher=()
  if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  cmake --preset "$preset" "${launcher[@]}" >"$root/build-$preset.log" 2>&1 || {
    cat "$root/build-$preset.log" >&2
    exit 1
  }
  mkdir -p "build/$preset" && mv "$root/build-$preset.log" "build/$preset/configure.log"
  cmake --build --preset "$preset" ${1:+--target "$@"}
}
