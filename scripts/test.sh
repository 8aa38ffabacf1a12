#!/usr/bin/env bash
# Set up, build and pass the tests.
#   scripts/test.sh [--full | --short]     --full: also what CI runs and the slow tier; --short: a named few programs, in a few minutes
# JOBS and CLOTHBENCH_CMAKE: see scripts/common.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/common.sh

# --short: what differs first on another system: readers of JSON, HDF5 and meshes, exact arithmetic, Bullet, Vulkan, the command.
short=(assets_test bullet_test check_test cli_test contact_test pbd_gpu_self_contact_test results_test scenario_test truth_test)

# A first build compiles files together, in about half the time, and leaves out slow tests that are not run; a folder
# that was configured before keeps its choice of both.
build() {
  local first=()
  [ -f build/release/CMakeCache.txt ] || first=(-DCMAKE_UNITY_BUILD=ON)
  case $tier in
    full) first+=(-DCLOTHBENCH_TESTS=slow) ;;
    *) [ ${#first[@]} -eq 0 ] || first+=(-DCLOTHBENCH_TESTS=quick) ;;
  esac
  configure ci "${first[@]}"
  cmake --build --preset ci -j "$JOBS" --target "${targets[@]}"
}
# One more than the machine has cores: some tests wait for a clock or another program.
tests() { ctest --test-dir build/release --output-on-failure -j $((JOBS + 1)) "${selection[@]}"; }

# A study's short form against its committed baseline; gates nothing that depends on the machine's speed.
#   against_baseline STUDY OPTIONS...    $kind: the end of the name of the baseline
against_baseline() {
  local study=$1 out=build/$1-quick
  shift
  rm -rf "$out"
  build/release/clothbench study "$study" --quick --out "$out" "$@" >"$out.txt" || { tail -20 "$out.txt"; return 1; }
  tail -1 "$out.txt"
  build/release/clothbench check "$out" --baseline "results/baselines/$study$kind.json" --junit "$out.xml"
}

# What penetrates what: the published scenes, and scenes drawn by fixed seeds. Beside them the stiff and extreme cases: the first of the three
# has timed trials, which are run one at a time and use one core.
studies() {
  local kind='' procedural=()
  # Results on procedural rooms and hands have baselines of their own.
  if build/release/clothbench list assets | grep -q '^procedural'; then kind=-procedural procedural=(--procedural); fi
  against_baseline penetration &
  local penetration=$!
  trap wait EXIT
  against_baseline contact --seed 1 "${procedural[@]}"
  stability
  wait "$penetration"
}

# Stiff and extreme cases: no process dies, and xpbd is finite and bounded in every case that it supports.
stability() {
  local out=build/stability-quick
  rm -rf "$out"
  build/release/clothbench --json study stability --quick --out "$out" >"$out.json" || { tail -20 "$out.json"; return 1; }
  /usr/bin/python3 - "$out.json" <<'END'
import json, sys
study = json.load(open(sys.argv[1], encoding="utf-8"))
ours = [r for r in study["runs"] if r["solver"] == "xpbd" and r["outcome"]["status"] != "unsupported"]
bad = [r["scene"] for r in ours if not (r["outcome"]["class"] == "ok" and r["summary"]["stability_grade"] in (0, 1, 2))]
if study["crashed"] != 0 or bad or not ours:
    sys.exit(f"stability: {study['crashed']} processes crashed; of {len(ours)} runs of xpbd out of bounds: {bad}")
END
}

tier=quick selection=(-LE '^(slow|ci)$') targets=(all) packages=(--tests)
case ${1:-} in
  '') ;;
  --full) tier=full selection=() packages=(--tests --ci) ;;
  --short)
    tier=short packages=(--short)
    targets=(clothbench "${short[@]}")
    # Without cases that take long and show nothing else on another system, or that judge speed.
    selection=(-LE '^(slow|ci)$' -R "^($(IFS='|'; echo "${short[*]}"))\\." -E 'EveryShippedFileLoads|OwnOverhead|PartEveryPair|RepeatBitForBit|FrictionHolds|Of200Seeds|ManyThreadsDraw|FalseAlarms|TwoCommandsAtOnce|AThinSheet|AShortList|TriangleMesh')
    ;;
  *) echo "usage: scripts/test.sh [--full | --short]" >&2; exit 2 ;;
esac
stage set-up 3 scripts/bootstrap.sh "${packages[@]}"
stage assets 1 scripts/fetch-assets.sh
stage build 8 build
stage --show tests 8 tests
if [ "$tier" != short ]; then
  stage studies 4 studies
fi
print_budget
