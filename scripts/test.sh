#!/usr/bin/env bash
# Set up, build and pass the tests.
#   scripts/test.sh [--full]     --full: the slow tier too
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/budget.sh

build() {
  cmake --preset ci >build/configure.log 2>&1 || { tail -30 build/configure.log; return 1; }
  cmake --build --preset ci -j "${JOBS:-2}"
}
tests() { ctest --test-dir build/release --output-on-failure -j "${JOBS:-2}" "${selection[@]}"; }

selection=(-LE slow)
[ "${1:-}" = --full ] && selection=()
mkdir -p build
stage set-up 4 scripts/bootstrap.sh --tests
stage build 8 build
stage tests 8 tests
print_budget
