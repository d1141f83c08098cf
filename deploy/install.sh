#!/usr/bin/env bash
# Installs what a bare Debian 12 lacks to build Macula: deploy/install.sh [build] [test]
# Asks dpkg first, so a second call runs no apt. As root, or through sudo, and says so.
set -euo pipefail

packages_file=$(dirname "$0")/packages.txt

packages_of() {  # packages_of SECTION
  awk -v want="[$1]" '/^\[/ { on = ($0 == want); next } on && !/^#/ && NF { print $1 }' "$packages_file"
}

missing_of() {  # those of the arguments that dpkg does not have installed
  local package
  for package in "$@"; do
    dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

main() {
  local sections=("${@:-build}") wanted=() missing=()
  local section
  for section in "${sections[@]}"; do mapfile -t -O "${#wanted[@]}" wanted < <(packages_of "$section"); done
  mapfile -t missing < <(missing_of "${wanted[@]}")
  if [ "${#missing[@]}" -eq 0 ]; then
    return
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "deploy: these packages are missing and neither root nor sudo is at hand: ${missing[*]}" >&2
      exit 1
    }
    as_root=(sudo)
  fi
  echo "deploy: installing ${#missing[@]} packages${as_root[0]:+ through sudo}: ${missing[*]}" >&2
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    "${missing[@]}" >/dev/null
}

main "$@"
