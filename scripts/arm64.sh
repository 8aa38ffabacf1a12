#!/usr/bin/env bash
# Tests the device build without a device: library, command, activity and APK for arm64, built with Debian's cross
# compiler and run under qemu-user with arm64 lavapipe. If ANDROID_NDK is set, builds the real APK too.
#   scripts/arm64.sh
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/common.sh

build() {
  cmake --preset arm64-linux
  cmake --build --preset arm64-linux -j "$JOBS" --target clothbench clothbench_quest fake_host clothbench_assets_packed null_xr_runtime
}
# Builds the program for this machine, for comparison and for importing results of the device build.
host() {
  [ -f build/release/CMakeCache.txt ] || configure release -DBUILD_TESTING=OFF
  cmake --build build/release -j "$JOBS" --target clothbench
}
android() {
  cmake --preset android-arm64
  cmake --build --preset android-arm64 -j "$JOBS" --target clothbench clothbench_apk
}

stage set-up 4 scripts/bootstrap.sh --arm64
stage packages 2 scripts/fetch-arm64-root.sh
stage build 5 build
stage host 5 host
stage --show tests 4 env CLOTHBENCH_NO_SKIPS=1 ctest --preset arm64-linux -j "$JOBS"
if [ -n "${ANDROID_NDK:-}" ]; then
  stage android 5 android
else
  echo "the APK for a headset was not built, because ANDROID_NDK is not set"
fi
print_budget
