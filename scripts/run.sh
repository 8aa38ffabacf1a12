#!/usr/bin/env bash
# The main job: set up, build, run the Table 3 study on the best Vulkan device present, print the table.
#   scripts/run.sh [--full] [options of `clothbench study`]
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/budget.sh

build() {
  cmake --preset release -DBUILD_TESTING=OFF >build/configure.log 2>&1 || { tail -30 build/configure.log; return 1; }
  cmake --build --preset release -j "${JOBS:-2}" --target clothbench
}

mkdir -p build
stage set-up 4 scripts/bootstrap.sh
stage build 5 build
out="results/runs/table3-$(date -u +%Y%m%dT%H%M%SZ)"
study_limit=5
for argument in "$@"; do [ "$argument" = --full ] && study_limit=60; done
stage study $study_limit build/release/clothbench study table3 --out "$out" "$@"
stage report 1 build/release/clothbench report "$out" -o "$out/report"
echo
echo "results: $out/*.h5 (HDF5; .xdmf beside each opens in ParaView)"
echo "report:  $out/report/report.md"
print_budget
