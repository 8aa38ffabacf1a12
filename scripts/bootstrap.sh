#!/usr/bin/env bash
# Installs the missing ones of clothbench's Debian 12 or 13 packages. Sourced or run by run.sh and test.sh.
#   scripts/bootstrap.sh [--short | --tests] [--ci] [--arm64]     --tests: also what only the tests use; --short: what those of test.sh --short use
#                                                                 --ci: what only CI's tests and the slow ones use
#                                                                 --arm64: also the cross build and the packaging of the APK
set -euo pipefail

packages=(clang cmake make ninja-build ccache
          glslc spirv-tools spirv-headers libvulkan-dev mesa-vulkan-drivers
          libbullet-dev libeigen3-dev libbenchmark-dev nlohmann-json3-dev libvalijson-dev libhdf5-dev zlib1g-dev libcli11-dev
          libfmt-dev libboost-dev libcgal-dev libgmp-dev libmpfr-dev libtinygltf-dev libtinyobjloader-dev libopenxr-dev libopenxr-loader1 libpng-dev fonts-dejavu-core
          python3-h5py python3-matplotlib librsvg2-bin git)
# The report's page is bundled with Node 18 or later. Debian's npm conflicts with others, so an existing npm is used.
command -v npm >/dev/null || packages+=(nodejs npm)
for argument in "$@"; do
  case $argument in
    --short) packages+=(g++ libgtest-dev vulkan-validationlayers) ;;
    --tests) packages+=(g++ xz-utils libgtest-dev vulkan-validationlayers hdf5-tools python3-yaml python3-xarray python3-h5netcdf
                        libbenchmark-tools clang-format pmccabe) ;;
    --ci) packages+=(python3-paraview chromium libclang-rt-dev slurm-wlm munge) ;;
    --arm64) packages+=(g++-aarch64-linux-gnu qemu-user-static aapt zipalign apksigner android-framework-res
                        default-jre-headless android-platform-frameworks-native-headers android-liblog-dev
                        android-libnativehelper-dev) ;;
    *) echo "set-up: $argument: expected --short, --tests, --ci or --arm64" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$package")
done
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
log=$(mktemp)
export DEBIAN_FRONTEND=noninteractive
install() { "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"; }
if ! { "${sudo[@]}" apt-get update && install; } >"$log" 2>&1; then
  tail -20 "$log" >&2
  echo "set-up: apt-get failed (whole output: $log)" >&2
  exit 1
fi
rm -f "$log"
