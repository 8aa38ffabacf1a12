#!/usr/bin/env bash
# The device build without a device: library, command, activity and APK for arm64 with Debian's cross compiler, run under
# qemu-user with arm64 lavapipe. Where ANDROID_NDK is set, the real APK is built too.
#   scripts/arm64.sh
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/budget.sh

# Arguments: whether a folder's files are compiled six at a time; whether warnings are errors.
compile() {
  cmake --preset arm64-linux -DCMAKE_UNITY_BUILD="$1" -DCMAKE_UNITY_BUILD_BATCH_SIZE=6 -DCLOTHBENCH_WERROR="$2" \
    >build/configure-arm64.log 2>&1 || { tail -30 build/configure-arm64.log; return 1; }
  cmake --build --preset arm64-linux -j "${JOBS:-2}" --target clothbench clothbench_quest fake_host clothbench_assets_packed null_xr_runtime
}
# Six at a time takes a third of the time, but two files' helpers of one name clash then, and names shadow others.
build() {
  compile ON OFF >build/arm64-unity.log 2>&1 && return
  grep -m 5 'error:' build/arm64-unity.log || tail -5 build/arm64-unity.log
  echo "arm64: compiling file by file instead (a clash of names? then SKIP_UNITY_BUILD_INCLUSION for one of the two)"
  compile OFF ON
}
# The machine's own command, to compare with and to import what the device build wrote.
host() {
  [ -f build/release/CMakeCache.txt ] || cmake --preset release -DBUILD_TESTING=OFF >build/configure.log 2>&1
  cmake --build build/release -j "${JOBS:-2}" --target clothbench
}
android() {
  cmake --preset android-arm64 >build/configure-android.log 2>&1 || { tail -30 build/configure-android.log; return 1; }
  cmake --build --preset android-arm64 -j "${JOBS:-2}" --target clothbench clothbench_apk
}

mkdir -p build
stage set-up 4 scripts/bootstrap.sh --arm64
stage packages 2 scripts/fetch-arm64-root.sh
stage build 5 build
stage host 5 host
stage tests 4 env CLOTHBENCH_NO_SKIPS=1 ctest --preset arm64-linux -j "${JOBS:-2}"
if [ -n "${ANDROID_NDK:-}" ]; then
  stage android 5 android
else
  echo "ANDROID_NDK is not set: the APK for a headset was not built"
fi
print_budget
