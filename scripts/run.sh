#!/usr/bin/env bash
# The main job: set up, build, run a study on the best Vulkan device present, print its tables.
#   scripts/run.sh [STUDY] [--full | --quick] [options of `clothbench study`]     STUDY: table3 (the default), penetration, stability
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/budget.sh

build() {
  cmake --preset release -DBUILD_TESTING=OFF >build/configure.log 2>&1 || { tail -30 build/configure.log; return 1; }
  cmake --build --preset release -j "${JOBS:-2}" --target clothbench
}

study=table3
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
  study=$1
  shift
fi
require=()
study_limit=5
for argument in "$@"; do
  [ "$argument" = --full ] && study_limit=60
  [ "$argument" = --require-assets ] && require=(--require-assets)
done

mkdir -p build
stage set-up 4 scripts/bootstrap.sh
stage assets 8 scripts/fetch-assets.sh "${require[@]}"
stage build 5 build
out="results/runs/$(basename "$study" .json)-$(date -u +%Y%m%dT%H%M%SZ)"
stage study $study_limit build/release/clothbench study "$study" --out "$out" "$@"
stage report 1 build/release/clothbench report "$out" -o "$out/report"
echo
echo "results: $out/*.h5 (HDF5; .xdmf beside each opens in ParaView)"
echo "report:  $out/report/index.html (open it in a browser), report.md beside it"
print_budget
