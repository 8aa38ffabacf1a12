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
# What the compiler does not need comes during the build, because one needs the network and the other the processor.
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
# Times of a software device tell nothing about a GPU, and all sizes take it many minutes.
build/release/clothbench list devices --json | grep -q '"software": false' || form=(--quick)
stage study 3 build/release/clothbench study "$study" --out "$out" "${form[@]}" "$@"
stage --show report 1 build/release/clothbench report "$out" -o "$out/report"
echo
echo "results: $out/*.h5 (HDF5; .xdmf beside each opens in ParaView)"
echo "report:  $out/report/index.html (open it in a browser), report.md beside it"
print_budget
