#!/usr/bin/env bash
# The thin client stays thin and the server needs no display: asserts what each one asks for itself. What
# its libraries ask for is theirs: Debian's libavcodec brings libx264 along.
set -euo pipefail
cd "$(dirname "$0")/.."

refuse() {  # refuse PROGRAM PATTERN
  local linked
  linked=$(readelf -d "$1" | grep NEEDED)
  if grep -E "$2" <<<"$linked"; then
    echo "check_links: $1 must not link the above" >&2
    exit 1
  fi
}

refuse build/client-only/bin/macula-client 'libembree|libopencv|OpenEXR|libtinygltf|libassimp|libx264|libtbb'
refuse build/server-only/bin/macula-server 'libglfw|libGL\.|libOpenGL|libepoxy|libopenxr'
echo "check_links: client and server link only their own libraries"
