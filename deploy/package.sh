#!/usr/bin/env bash
# Makes macula-server_*.deb and macula-client_*.deb in build/packages: ./deploy/package.sh [--no-install] [--try]
#   --no-install  take the machine as it is (no apt)
#   --try         then install them into a fresh Debian 12 (root and debootstrap needed), look at the service
#                 unit, stream a picture from server to client there, remove and purge them
source "$(dirname "$0")/common.sh"

install=yes try=no
for argument in "$@"; do
  case $argument in
    --no-install) install=no ;;
    --try) try=yes ;;
    -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "deploy/package.sh: unknown option '$argument' (known: --no-install, --try)" >&2; exit 2 ;;
  esac
done
if [ "$install" = yes ]; then "$root/deploy/install.sh" build package; fi

packages=$root/build/packages
# Without MPI: who serves from one machine need not install it (DECISIONS.md).
configure package
cmake --build --preset package --target macula_server macula_client
rm -rf "$packages"
cpack --config build/package/CPackConfig.cmake -B "$packages" >"$root/build/cpack.log" 2>&1 || {
  cat "$root/build/cpack.log" >&2
  exit 1
}
rm -rf "$packages/_CPack_Packages"
ls -l "$packages"
[ "$try" = yes ] || exit 0

clean=$root/build/debian-root
if [ ! -x "$clean/usr/bin/apt-get" ]; then debootstrap --variant=minbase bookworm "$clean" >"$root/build/debootstrap.log"; fi
in_clean() { chroot "$clean" env DEBIAN_FRONTEND=noninteractive HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
cleanup() { for place in proc dev/pts dev; do umount "$clean/$place" 2>/dev/null || true; done; }
trap cleanup EXIT
mount --bind /proc "$clean/proc"
mount --bind /dev "$clean/dev"
mount -t devpts devpts "$clean/dev/pts" 2>/dev/null || true
cp /etc/resolv.conf "$clean/etc/resolv.conf"
rm -rf "$clean/packages" && mkdir -p "$clean/packages"
cp "$packages"/*.deb "$clean/packages/"
in_clean apt-get update -qq
in_clean apt-get install -y -qq --no-install-recommends libarchive-tools systemd >/dev/null 2>&1
# What is there before, so that removal can be held against it; packages they pulled in may stay.
before=$(in_clean find /etc /usr/bin /usr/share/doc /lib/systemd/system /var/lib -name '*macula*' | sort)
in_clean sh -c 'apt-get install -y -qq --no-install-recommends /packages/*.deb' >/dev/null
echo "== installed"
in_clean macula-server --version
in_clean macula-client --version
echo "== systemd-analyze verify and security"
in_clean systemd-analyze verify macula-server.service
in_clean systemd-analyze security --offline=true --no-pager macula-server.service | tail -1
echo "== a stream, as the service's user"
in_clean sh -ec '
  mkdir -p /var/lib/macula && chown macula:macula /var/lib/macula && chmod 700 /var/lib/macula
  cd /tmp
  setpriv --reuid=macula --regid=macula --clear-groups macula-server --config /etc/macula/server.toml \
    --keys /var/lib/macula --bind tcp://127.0.0.1:7799 >/tmp/server.log 2>&1 &
  server=$!
  for i in $(seq 100); do grep -q "^ready on" /tmp/server.log && break; sleep 0.1; done
  setpriv --reuid=macula --regid=macula --clear-groups macula-server pair --bind tcp://127.0.0.1:7798 \
    --keys /var/lib/macula >/tmp/pair.log 2>&1 &
  for i in $(seq 100); do grep -q "^code: " /tmp/pair.log && break; sleep 0.1; done
  macula-client pair --connect tcp://127.0.0.1:7798 --code "$(sed -n "s/^code: //p" /tmp/pair.log)" --name trial
  macula-client --connect tcp://127.0.0.1:7799 --display headless --size 128x128 --frames 10 --out /tmp/out
  kill -TERM $server
  wait $server'
echo "== removed"
in_clean apt-get remove -y -qq macula-server macula-client >/dev/null
in_clean find /etc /usr/bin /usr/share/doc /lib/systemd/system /var/lib -name '*macula*' -not -path '/var/lib/dpkg/*' | sort
in_clean dpkg --purge macula-server >/dev/null
after=$(in_clean find /etc /usr/bin /usr/share/doc /lib/systemd/system /var/lib -name '*macula*' | sort)
echo "== purged"
[ "$before" = "$after" ] || { diff <(echo "$before") <(echo "$after"); exit 1; }
echo "package: installed, streamed, removed, purged; nothing is left"
