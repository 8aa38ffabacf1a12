#!/usr/bin/env bash
# Set up, build and pass the tests.
#   scripts/test.sh [--full]     --full: the slow tier too
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/budget.sh

# Argument: whether files are compiled eight at a time, half the work of a first build and more than it for every later one; who asks for that
# (CI) builds no slow test that it does not run.
compile() {
  local slow=ON
  [ "$1" = OFF ] || [ ${#selection[@]} -eq 0 ] || slow=OFF
  cmake --preset ci -DCLOTHBENCH_SLOW_TESTS=$slow -DCMAKE_UNITY_BUILD="$1" -DCMAKE_UNITY_BUILD_BATCH_SIZE=8 >build/configure.log 2>&1 || { tail -30 build/configure.log; return 1; }
  cmake --build --preset ci -j "${JOBS:-2}"
}
build() {
  [ "${CLOTHBENCH_UNITY:-}" != 1 ] || ! compile ON || return 0
  compile OFF
}
tests() { ctest --test-dir build/release --output-on-failure -j "${JOBS:-2}" "${selection[@]}"; }

# What penetrates what, against the committed baseline; gates nothing that depends on the machine's speed.
penetration() {
  local baseline=results/baselines/penetration.json out=build/penetration-quick
  rm -rf "$out"
  build/release/clothbench study penetration --quick --out "$out" >"$out.txt" || { tail -20 "$out.txt"; return 1; }
  tail -1 "$out.txt"
  build/release/clothbench check "$out" --baseline "$baseline" --junit build/penetration-quick.xml
}

# Stiff and extreme cases: every run ends in a row, whatever becomes of the solver, and none of its processes dies.
stability() {
  local out=build/stability-quick
  rm -rf "$out" "$out-report"
  build/release/clothbench --json study stability --quick --jobs "${JOBS:-2}" --out "$out" >"$out.json" || { tail -20 "$out.json"; return 1; }
  build/release/clothbench report "$out" -o "$out-report" >"$out-report.txt" || { tail -20 "$out-report.txt"; return 1; }
  # Ours stays finite and bounded whatever the case, and repeats itself.
  scripts/check_stability.py "$out.json" "$out-report"
}

selection=(-LE slow)
[ "${1:-}" = --full ] && selection=()
mkdir -p build
stage set-up 4 scripts/bootstrap.sh --tests
stage assets 8 scripts/fetch-assets.sh
stage build 8 build
stage tests 8 tests
stage contact 3 penetration
stage stability 4 stability
print_budget
