#!/usr/bin/env bash
# Shows Macula at work: builds what is needed, starts a server and a client on this machine, and leaves
# demo-out/ with pictures of both eyes, the foveation map, a contact sheet and report.json.
#   ./deploy/demo.sh [--no-install] [--headless] [--scene NAME|FILE] [--frames N]
# Where a display is present a window opens (mouse = gaze, right drag and W A S D = head, Esc = end).
source "$(dirname "$0")/common.sh"

install=yes mode=auto scene=atrium frames=480 out=$root/demo-out
while [ $# -gt 0 ]; do
  case $1 in
    --no-install) install=no ;;
    --headless) mode=headless ;;
    --scene) scene=${2:?--scene needs a name or a file}; shift ;;
    --frames) frames=${2:?--frames needs a number}; shift ;;
    -h | --help) sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "deploy/demo.sh: unknown option '$1' (known: --no-install, --headless, --scene, --frames)" >&2; exit 2 ;;
  esac
  shift
done
if [ "$install" = yes ]; then "$root/deploy/install.sh" build; fi

# Tests need packages that a demonstration does not: build the two programs alone.
if [ ! -f build/release/build.ninja ]; then configure release -DMACULA_TESTS=OFF; fi
cmake --build --preset release --target macula_server macula_client

bin=$root/build/release/bin
keys=$(mktemp -d)
server=
cleanup() {
  if [ -n "$server" ]; then kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; fi
  rm -rf "$keys"
}
trap cleanup EXIT

mkdir -p "$out"
# A machine that renders and shows at once has little time for a frame: few samples, and a budget that
# the periphery pays for.
"$bin/macula-server" --scene "$scene" --area-samples 1 --ambient-samples 4 --target-ms 150 --guard-deg 10 \
  --bind tcp://127.0.0.1:0 --keys "$keys" >"$out/server.log" 2>&1 &
server=$!
endpoint=
for _ in $(seq 300); do
  endpoint=$(sed -n 's/.*ready on \(tcp:[^ ]*\).*/\1/p' "$out/server.log" | head -1)
  [ -n "$endpoint" ] && break
  kill -0 "$server" 2>/dev/null || { cat "$out/server.log" >&2; exit 1; }
  sleep 0.1
done
[ -n "$endpoint" ] || { echo "deploy/demo.sh: the server did not become ready; see $out/server.log" >&2; exit 1; }

display=headless
if [ "$mode" = auto ] && [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then display=window; fi
if [ "$display" = window ]; then
  echo "demo: a window shows $scene; close it (Esc) and the headless pictures follow"
  "$bin/macula-client" --connect "$endpoint" --keys "$keys" --display window || true
fi
"$bin/macula-client" --connect "$endpoint" --keys "$keys" --display headless --loop --frames "$frames" --out "$out"
echo "demo: look at $out/contact_sheet.png, eye_left.png, eye_right.png, rate_map.png and report.json beside it"
