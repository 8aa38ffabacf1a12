#!/usr/bin/env bash
# The main job: sets up, builds, runs a study on the best Vulkan device (without a GPU: its quick form), prints its tables.
#   scripts/run.sh [STUDY] [--quick] [options of `clothbench study`]     STUDY: table3 (the default), penetration, stability
# JOBS and CLOTHBENCH_CMAKE: see scripts/common.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/common.sh

build() {
  configure release -DBUILD_TESTING=OFF
  build_targets release clothbench
}
# Downloads that the compiler does not need run during the build: they wait for the network, while the build is limited by the CPU.
rest() { scripts/bootstrap.sh && scripts/fetch-assets.sh "${require[@]}"; }

case ${1:--} in
  -*) study=table3 ;;
  *) study=$1 && shift ;;
esac
require=() form=()
[[ " $* " != *' --require-assets '* ]] || require=(--require-assets)

stage set-up 2 scripts/bootstrap.sh --build
meanwhile rest
stage build 4 build
tail -1 "$stage_logs/meanwhile.log"
out="results/runs/$(basename "$study" .json)-$(date -u +%Y%m%dT%H%M%SZ)"
# A software device's times tell nothing about a GPU, and it needs many minutes for all sizes.
build/release/clothbench list devices --json | grep -q '"software": false' || form=(--quick)
stage study 3 build/release/clothbench study "$study" --out "$out" "${form[@]}" "$@"
stage --show report 1 build/release/clothbench report "$out" -o "$out/report"
echo
echo "results: $out/*.h5 (HDF5; .xdmf beside each opens in ParaView)"
echo "report:  $out/report/index.html (open it in a browser), report.md beside it"
print_budget
