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
sodium shared/pairing tests/faults
macula/v1/.*\.pb\.h shared/net tests/shared/net
google/protobuf shared/net tests/shared/net
tiny_gltf server/scene/gltf
assimp/ server/scene/assimp
embree server/visibility
OpenEXR/ server/exr
Imf server/exr
opencv2/ server/filters
prometheus/ server/exporter
mpi\.h server/cluster/mpi
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
may_include() {  # sets `may`; processes cost more than all the rest
  local low="shared/base shared/units shared/math"
  local pictures="$low shared/foveation shared/image"
  case $1 in
    shared/base) may="" ;;
    shared/units) may="shared/base" ;;
    shared/math) may="shared/base shared/units" ;;
    shared/foveation | shared/image) may="$low" ;;
    shared/pairing) may="shared/base shared/units" ;;
    shared/codec | shared/metrics) may="$pictures" ;;
    shared/net) may="$pictures shared/pairing" ;;
    server/sdf) may="$pictures" ;;
    server/scheduling | server/sampling) may="$low shared/image" ;;
    server/exr) may="$low shared/image" ;;
    server/scene) may="$pictures shared/codec server/exr server/sdf" ;;
    server/visibility) may="$pictures server/scene server/sampling" ;;
    server/shading) may="$pictures server/scene server/sampling server/visibility" ;;
    server/lights) may="$pictures server/scene server/sampling server/shading" ;;
    server/filters | server/reconstruction) may="$pictures" ;;
    server/kernels | server/kernels/*)
      may="$pictures server/kernels server/scheduling server/sampling server/scene server/visibility server/shading server/lights server/filters server/reconstruction server/sdf" ;;
    server/cluster) may="$pictures server/kernels server/scheduling server/scene" ;;
    server/cluster/mpi) may="$low server/scheduling" ;;
    server/disocclusion)
      may="$pictures server/kernels server/scheduling server/sampling server/scene server/visibility server/sdf" ;;
    server/session) may="shared server/scene server/scheduling server/kernels server/disocclusion" ;;
    server/exporter) may="shared server/session" ;;
    server/app) may="shared server" ;;
    client/pose | client/reprojection) may="$pictures" ;;
    client/frames) may="$pictures shared/codec shared/net" ;;
    client/display/gl) may="$pictures client/reprojection" ;;
    client/display/*) may="client/display/gl $pictures shared/net client/pose client/frames client/reprojection" ;;
    client/app) may="shared client" ;;
    *) may="?" ;;
  esac
}
find_room() {  # shared/image/png.cpp -> shared/image, in `room`
  local parts
  IFS=/ read -ra parts <<<"$1"
  case $1 in
    server/kernels/*/* | server/cluster/*/* | client/display/*/*) room=${parts[0]}/${parts[1]}/${parts[2]} ;;
    *) room=${parts[0]}/${parts[1]} ;;
  esac
}
last=
while IFS=: read -r file included; do
  included=${included#*\"} included=${included%%\"*}
  if [ "$file" != "$last" ]; then
    last=$file
    find_room "$file"
    of=$room
    may_include "$of"
    [ "$may" = "?" ] && report "$file lies in a room that no rule knows"
  fi
  [ -z "$included" ] && continue
  find_room "$included"
  [ "$room" = "$of" ] || [ "$may" = "?" ] && continue
  for permitted in $may; do
    case $room in $permitted | $permitted/*) continue 2 ;; esac
  done
  report "$file includes $included, but $of may not include $room"
done < <(sources shared server client | xargs awk '
  FNR == 1 { print FILENAME ":" }
  /^#include "(shared|server|client)\// { print FILENAME ":" $0 }')

# Folder = namespace.
while IFS= read -r file; do
  find_room "$file"
  name=${room##*/}
  case $room in
    server/kernels/*) name=kernels ;;
    server/cluster/*) name=cluster ;;
    client/display/*) name=display ;;
    server/app) name=server_app ;;
    client/app) name=client_app ;;
  esac
  case $file in */main.cpp | *_simd.cpp) continue ;; esac
  [[ $(<"$file") =~ namespace\ macula::$name($|[^a-z_0-9]) ]] || report "$file does not open namespace macula::$name"
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
