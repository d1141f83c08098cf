# Sourced by demo.sh and test.sh: where we are, how we build.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

# ccache finds a fresh clone's objects only when paths are relative to its root.
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1

configure() {  # configure PRESET [cmake options...]
  local preset=$1
  shift
  local launcher=()
  if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  mkdir -p "build/$preset"
  cmake --preset "$preset" "${launcher[@]}" "$@" >"build/$preset/configure.log" 2>&1 || {
    cat "build/$preset/configure.log" >&2
    exit 1
  }
}

configure_and_build() {  # configure_and_build PRESET [cmake options...]
  configure "$@"
  cmake --build --preset "$1"
}
