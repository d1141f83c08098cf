#!/usr/bin/env bash
# A real OpenXR runtime for the tests, without a GPU: Monado of the next Debian release, unpacked into
# a folder of its own and run with its own libraries, so that nothing of the system changes.
#   monado.sh prepare DIR            fetches and unpacks it (about 165 MB, 600 MB on disk) unless it is there
#   monado.sh exec DIR PROGRAM ...   runs a program inside: monado-service, or a client of it
set -euo pipefail

fetch() {  # fetch DIR: the packages, through apt and its own idea of where packages come from
  local dir=$1 apt=$1/.apt mirror
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Identifier: Packages' | head -1)
  [ -n "$mirror" ] || { echo "monado: apt knows no package source" >&2; return 1; }
  mkdir -p "$apt"/{lists/partial,archives/partial} && : >"$apt/status"
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror trixie main" >"$apt/sources.list"
  local options=(-qq -o "Dir::Etc::sourcelist=$apt/sources.list" -o Dir::Etc::sourceparts=/dev/null
    -o Dir::Etc::preferencesparts=/dev/null -o "Dir::State::lists=$apt/lists" -o "Dir::Cache::archives=$apt/archives"
    -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o "Dir::State::status=$apt/status"
    -o Debug::NoLocking=1 -o APT::Sandbox::User=root -o Acquire::Languages=none)
  apt-get "${options[@]}" update
  apt-get "${options[@]}" -y --no-install-recommends --download-only install monado-service libopenxr1-monado \
    libopenxr-loader1 mesa-vulkan-drivers libgl1-mesa-dri libglx-mesa0 libgl1 >/dev/null
}

unpack() {  # unpack DIR
  local package
  for package in "$1"/.apt/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$package" | tar -x --keep-directory-symlink -C "$1" \
      --exclude='./usr/share/doc*' --exclude='./usr/share/man*' --exclude='./usr/share/locale*'
  done
  rm -r "$1/.apt"
}

libraries_of() { echo "$1/usr/lib/x86_64-linux-gnu"; }

prepare() {  # prepare DIR
  [ -f "$1/ready" ] && return
  rm -rf "$1" && mkdir -p "$1"
  fetch "$1" && unpack "$1"
  local libraries
  libraries=$(libraries_of "$1")
  sed "s#\"library_path\": \"#&$libraries/#" "$1/usr/share/vulkan/icd.d/lvp_icd.json" >"$1/lvp.json"
  echo "{\"file_format_version\":\"1.0.0\",\"runtime\":{\"name\":\"Monado\",\"library_path\":\"$libraries/libopenxr_monado.so\"}}" \
    >"$1/monado.json"
  touch "$1/ready"
}

exec_inside() {  # exec_inside DIR PROGRAM ...
  local dir=$1 libraries
  shift
  libraries=$(libraries_of "$dir")
  export VK_ICD_FILENAMES=$dir/lvp.json VK_DRIVER_FILES=$dir/lvp.json VK_LOADER_LAYERS_DISABLE=~all~ \
    XR_RUNTIME_JSON=$dir/monado.json LIBGL_DRIVERS_PATH=$libraries/dri \
    __EGL_VENDOR_LIBRARY_DIRS=$dir/usr/share/glvnd/egl_vendor.d LIBGL_ALWAYS_SOFTWARE=1
  exec "$dir/usr/lib64/ld-linux-x86-64.so.2" --library-path \
    "$libraries:$dir/usr/lib:$libraries/blas:$libraries/lapack:$libraries/pulseaudio:$libraries/dri:/usr/lib/x86_64-linux-gnu" "$@"
}

case ${1:-} in
  prepare) prepare "$(realpath -m "${2:?a folder}")" ;;
  exec) shift && exec_inside "$(realpath "$1")" "${@:2}" ;;
  *) sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac
