#!/usr/bin/env bash
# The must-fail twin of check.sh: a small tree with one violation of each kind; every one must be named.
set -euo pipefail
check=${1:?usage: planted.sh CHECK}
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{proto,shared/{base,net,image},server/{kernels/ray,scene},client/frames,tests,deploy}

plant() {  # plant FILE TEXT...
  printf '%s\n' "${@:2}" >"$tree/$1"
}
plant shared/image/a.cpp 'namespace macula::image {}' '#include <zmq.hpp>'
plant shared/base/b.h 'namespace macula::base {}' '#include <spdlog/spdlog.h>'
plant server/kernels/ray/c.cpp 'namespace macula::kernels {}' '#include "shared/net/wire.h"'
plant client/frames/d.cpp 'namespace macula::frames {}' '#include "server/scene/scene.h"'
plant server/scene/e.cpp 'namespace macula::elsewhere {}'
plant shared/net/f.cpp 'namespace macula::net {' 'auto home = getenv("HOME"); }'
plant shared/base/g.cpp 'namespace macula::base { auto path = "../shared/data"; }'
plant server/CMakeLists.txt 'file(GLOB sources *.cpp)'

found=$("$check" "$tree" || true)
for expected in 'a.cpp includes <zmq' 'costly header in a header of ours: shared/base/b.h' \
  'c.cpp includes shared/net/wire.h' 'd.cpp includes server/scene/scene.h' \
  'e.cpp does not open namespace macula::scene' 'environment read outside app: shared/net/f.cpp' \
  'reaches outside the project: shared/base/g.cpp' 'forbidden in the build: ./server/CMakeLists.txt'; do
  grep -qF "$expected" <<<"$found" || { echo "planted violation was not found: $expected"; echo "$found"; exit 1; }
done
echo "layering: every planted violation was found"
