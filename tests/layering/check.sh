#!/usr/bin/env bash
# Holds the house: folder = namespace = target = the only includer of its third-party headers, and
# rooms include only what lies below them. check.sh ROOT prints each violation; exit 1 if there is one.
set -uo pipefail
cd "${1:?usage: check.sh ROOT}" || exit 2
violations=0
report() { echo "layering: $*"; violations=$((violations + 1)); }
sources() { find "$@" -name '*.h' -o -name '*.cpp' 2>/dev/null | sort; }

# A header (an extended regular expression after '#include <') and the folders that may include it.
while read -r header folders; do
  [ -z "$header" ] && continue
  while IFS=: read -r file _; do
    [ -z "$file" ] && continue
    for folder in $folders; do
      case $file in $folder/*) continue 2 ;; esac
    done
    report "$file includes <$header...>, which only $folders may"
  done < <(grep -rnE "#include [<\"]$header" --include='*.h' --include='*.cpp' proto shared server client tests 2>/dev/null)
done <<'RULES'
spdlog/ shared/base
tl/expected shared/base
glm/ shared/math
png\.h shared/image
turbojpeg shared/codec
zstd shared/codec
x264 shared/codec
libavcodec shared/codec
zmq shared/net tests
sodium shared/pairing
macula/v1/.*\.pb\.h shared/net tests/shared/net
google/protobuf shared/net tests/shared/net
tiny_gltf server/scene/gltf
assimp/ server/scene/assimp
embree server/visibility
OpenEXR/ server/exr
Imf server/exr
opencv2/ server/filters
GLFW/ client/display/window
epoxy/ client/display/gl tests/support/null_runtime
openxr/ client/display/openxr tests/support/null_runtime
CLI/ server/app client/app tests/bench
toml\.hpp server/app client/app server/scene
nlohmann/ server client tests/bench tests
(oneapi/)?tbb/ server/scheduling
hwy/ shared server client tests
RULES

# Costly headers are included by .cpp files only; the wire's own parts may share the generated ones.
while IFS= read -r line; do
  [ -n "$line" ] && report "costly header in a header of ours: $line"
done < <(grep -rnE '#include <(spdlog/|CLI/|toml\.hpp|nlohmann/|(oneapi/)?tbb/|opencv2/)|#include ["<]macula/v1/.*\.pb\.h' --include='*.h' shared server client | grep -v '^shared/net/wire_')

# Rooms that each room may include besides itself. Order: base <- units <- math <- {foveation, image}
# <- {codec, metrics} <- net; a kernel sees neither net nor session nor app.
allowed() {
  local low="shared/base shared/units shared/math"
  local pictures="$low shared/foveation shared/image"
  case $1 in
    shared/base) echo "" ;;
    shared/units) echo "shared/base" ;;
    shared/math) echo "shared/base shared/units" ;;
    shared/foveation | shared/image) echo "$low" ;;
    shared/pairing) echo "shared/base shared/units" ;;
    shared/codec | shared/metrics) echo "$pictures" ;;
    shared/net) echo "$pictures shared/pairing" ;;
    server/sdf) echo "$pictures" ;;
    server/scheduling | server/sampling) echo "$low shared/image" ;;
    server/exr) echo "$low shared/image" ;;
    server/scene) echo "$pictures shared/codec server/exr server/sdf" ;;
    server/visibility) echo "$pictures server/scene server/sampling" ;;
    server/shading) echo "$pictures server/scene server/sampling server/visibility" ;;
    server/lights) echo "$pictures server/scene server/sampling server/shading" ;;
    server/filters | server/reconstruction) echo "$pictures" ;;
    server/kernels | server/kernels/*)
      echo "$pictures server/kernels server/scheduling server/sampling server/scene server/visibility server/shading server/lights server/filters server/reconstruction server/sdf" ;;
    server/session) echo "shared server/scene server/scheduling server/kernels" ;;
    server/app) echo "shared server" ;;
    client/pose | client/reprojection) echo "$pictures" ;;
    client/frames) echo "$pictures shared/codec shared/net" ;;
    client/display/gl) echo "$pictures" ;;
    client/display/*) echo "client/display/gl $pictures shared/net client/pose client/frames client/reprojection" ;;
    client/app) echo "shared client" ;;
    *) echo "?" ;;
  esac
}
room_of() {  # shared/image/png.cpp -> shared/image
  case $1 in
    server/kernels/*/* | client/display/*/*) cut -d/ -f1-3 <<<"$1" ;;
    *) cut -d/ -f1-2 <<<"$1" ;;
  esac
}
while IFS= read -r file; do
  room=$(room_of "$file")
  may=$(allowed "$room")
  if [ "$may" = "?" ]; then report "$file lies in a room that no rule knows"; continue; fi
  while IFS= read -r included; do
    target=$(room_of "$included")
    [ "$target" = "$room" ] && continue
    for permitted in $may; do
      case $target in $permitted | $permitted/*) continue 2 ;; esac
    done
    report "$file includes $included, but $room may not include $target"
  done < <(sed -nE 's/^#include "((shared|server|client)\/[^"]+)".*/\1/p' "$file")
done < <(sources shared server client)

# Folder = namespace.
while IFS= read -r file; do
  room=$(room_of "$file")
  name=$(basename "$room")
  case $room in
    server/kernels/*) name=kernels ;;
    client/display/*) name=display ;;
    server/app) name=server_app ;;
    client/app) name=client_app ;;
  esac
  case $file in */main.cpp | *_simd.cpp) continue ;; esac
  grep -qE "namespace macula::$name\b" "$file" || report "$file does not open namespace macula::$name"
done < <(sources shared server client)

# Arguments and environment reach app alone; nothing looks outside the project; no tricks in the build.
while IFS= read -r line; do [ -n "$line" ] && report "environment read outside app: $line"; done \
  < <(grep -rnE '\b(std::)?(secure_)?getenv\(' --include='*.h' --include='*.cpp' shared server client | grep -vE '^(server|client)/app/')
while IFS= read -r line; do [ -n "$line" ] && report "reaches outside the project: $line"; done \
  < <(grep -rnF '../shared/' --include='*.h' --include='*.cpp' --include='CMakeLists.txt' --include='*.sh' proto shared server client deploy 2>/dev/null)
while IFS= read -r line; do [ -n "$line" ] && report "forbidden in the build: $line"; done \
  < <(grep -rnE 'ffast-math|march=native|file\(GLOB|FetchContent|ExternalProject' --include='CMakeLists.txt' --include='CMakePresets.json' . 2>/dev/null | grep -v '^./build/')

[ "$violations" -eq 0 ] && echo "layering: the house is in order"
[ "$violations" -eq 0 ]
