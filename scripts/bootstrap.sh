#!/usr/bin/env bash
# Installs those Debian 12 or 13 packages that clothbench needs and this machine lacks. Called by run.sh and test.sh.
#   scripts/bootstrap.sh [--build | --short | --tests] [--ci] [--arm64]
# --build: only packages for compiling; otherwise also packages that the program needs at run time, and npm
# further packages: --short: for test.sh --short; --tests: for all tests of test.sh; --ci: for CI's tests and slow tests;
# --arm64: for the cross build and the packaging of the APK
set -euo pipefail

packages=(clang lld cmake ninja-build ccache git python3
          glslc spirv-tools spirv-headers libvulkan-dev
          libbullet-dev libeigen3-dev libbenchmark-dev nlohmann-json3-dev libhdf5-dev zlib1g-dev libcli11-dev libgtest-dev
          libfmt-dev libboost-dev libcgal-dev libgmp-dev libmpfr-dev libtinygltf-dev libtinyobjloader-dev libopenxr-dev libpng-dev)
used=(mesa-vulkan-drivers libopenxr-loader1 fonts-dejavu-core librsvg2-bin)
# The report's page is bundled with Node 18 or later.
command -v node >/dev/null || packages+=(nodejs)
[ "${1:-}" = --build ] || packages+=("${used[@]}")
for argument in "$@"; do
  case $argument in
    --build) ;;
    --short) packages+=(g++ make vulkan-validationlayers) ;;
    --tests) packages+=(g++ make xz-utils vulkan-validationlayers python3-h5py clang-format pmccabe) ;;
    --ci) packages+=(python3-paraview python3-xarray python3-h5netcdf python3-matplotlib chromium libclang-rt-dev slurm-wlm munge) ;;
    --arm64) packages+=(g++-aarch64-linux-gnu qemu-user-static aapt zipalign apksigner android-framework-res
                        default-jre-headless android-platform-frameworks-native-headers android-liblog-dev
                        android-libnativehelper-dev) ;;
    *) echo "set-up: $argument: expected --build, --short, --tests, --ci or --arm64" >&2; exit 2 ;;
  esac
done

# CI calls this from two processes.
exec 9<"$0"
flock 9
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$package")
done
# Only unpacked, where CMake finds it, because it requires the development packages of every library that it can be used with, such as Qt.
valijson=$(cd "$(dirname "$0")/.." && pwd)/build/valijson
[ -d /usr/include/valijson ] || [ -d "$valijson/usr" ] || missing+=(libvalijson-dev)
# Only unpacked, because Debian's npm conflicts with other installations, and its 350 packages would take a minute to install.
npm=${valijson%/*}/npm
[ "${1:-}" = --build ] || [ -x "$npm/npm" ] || command -v npm >/dev/null || missing+=(npm)
if [ ${#missing[@]} -eq 0 ]; then
  echo "set-up: all packages are installed"
  exit 0
fi
echo "set-up: installing ${missing[*]}"
sudo=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "set-up: run as root or install sudo (needed: apt-get install ${missing[*]})" >&2; exit 1; }
  sudo=(sudo)
fi
install=("${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends)
unpack_valijson() {
  mkdir -p "$valijson" && cd "$valijson" && apt-get download libvalijson-dev && dpkg-deb -x libvalijson-dev_*.deb unpacked && mv unpacked/usr .
}
unpack_npm() {
  mkdir -p "$npm/debs/partial" && "${install[@]}" --download-only -o Dir::Cache::archives="$npm/debs" npm || return
  local package
  for package in "$npm"/debs/{node-*,npm_*}.deb; do dpkg-deb -x "$package" "$npm" || return; done
  # shellcheck disable=SC2016  # for the script that is written
  printf '#!/bin/sh\nmodules=$(dirname "$0")/usr/share/nodejs\nNODE_PATH=$modules exec node "$modules/npm/bin/npm-cli.js" "$@"\n' >"$npm/npm"
  chmod +x "$npm/npm" && "${sudo[@]}" rm -r "$npm/debs"
}
install_missing() {
  local package installed=()
  "${sudo[@]}" apt-get update || return
  for package in "${missing[@]}"; do
    case $package in libvalijson-dev | npm) ;; *) installed+=("$package") ;; esac
  done
  [ ${#installed[@]} -eq 0 ] || "${install[@]}" "${installed[@]}" || return
  [[ " ${missing[*]} " != *' libvalijson-dev '* ]] || (unpack_valijson) || return
  [[ " ${missing[*]} " != *' npm '* ]] || unpack_npm
}
log=$(mktemp)
if ! install_missing >"$log" 2>&1 9>&-; then
  tail -20 "$log" >&2
  echo "set-up: apt-get failed (whole output: $log)" >&2
  exit 1
fi
rm -f "$log"
