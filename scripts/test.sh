#!/usr/bin/env bash
# Sets up, builds and runs the tests.
#   scripts/test.sh [--ci [options of ctest] | --full | --short]     --ci: only CI's further tests and studies; --full: all; --short: a few
# JOBS and CLOTHBENCH_CMAKE: see scripts/common.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/common.sh

# --short: tests of system-dependent parts: readers of JSON, HDF5 and meshes, Bullet, Vulkan, the command.
short=(assets_test bullet_test check_test cli_test pbd_gpu_self_contact_test results_test scenario_test truth_test)

build() {
  configure ci "${built[@]}"
  build_targets ci "${targets[@]}"
}
rest() { scripts/bootstrap.sh "${packages[@]}" && scripts/fetch-assets.sh; }
# One job more than cores, because some tests wait for a clock or another program.
tests() { ctest --test-dir build/release --output-on-failure -j $((JOBS + 1)) "${selection[@]}"; }

# Compares a study's short form with its committed baseline; values that depend on the machine's speed are not compared.
#   against_baseline STUDY OPTIONS...    $kind: suffix of the baseline's name
against_baseline() {
  local study=$1 out=build/$1-quick
  shift
  rm -rf "$out"
  build/release/clothbench study "$study" --quick --out "$out" "$@" >"$out.txt" || { tail -20 "$out.txt"; return 1; }
  tail -1 "$out.txt"
  build/release/clothbench check "$out" --baseline "results/baselines/$study$kind.json" --junit "$out.xml"
}

# By default the published scenes; --ci: random scenes with fixed seeds, and the stiff and extreme cases; --full: both.
studies() {
  local kind='' procedural=()
  # Results with procedural rooms and hands have separate baselines.
  if build/release/clothbench list assets | grep -q '^procedural'; then kind=-procedural procedural=(--procedural); fi
  [ "$tier" = ci ] || against_baseline penetration
  [ "$tier" != quick ] || return 0
  stability &
  local stability=$!
  trap wait EXIT
  against_baseline contact --seed 1 "${procedural[@]}"
  wait "$stability"
}

# Stiff and extreme cases: no process may die, and xpbd must be finite and bounded in every case that it supports.
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
    sys.exit(f"stability: {study['crashed']} processes crashed; xpbd is out of bounds in these of its {len(ours)} runs: {bad}")
END
}

tier=quick built=() selection=(-L '^quick$') targets=(all) packages=(--tests)
case ${1:-} in
  '') ;;
  --ci) tier=ci built=(-DCLOTHBENCH_TESTS=ci) selection=(-L '^ci$' "${@:2}") packages=(--tests --ci) ;;
  --full) tier=full built=(-DCLOTHBENCH_TESTS=slow) selection=() packages=(--tests --ci) ;;
  --short)
    tier=short packages=(--short)
    targets=(clothbench "${short[@]}")
    # Without slow cases that show nothing new on a different system, and without tests of speed.
    selection=(-LE '^(slow|ci)$' -R "^($(IFS='|'; echo "${short[*]}"))\\." -E 'EveryShippedFileLoads|Draw|DropNoPair|PenetrationHas|OwnOverhead|RepeatBitForBit|FrictionHolds|Of200Seeds|FalseAlarms|TwoCommandsAtOnce|AThinSheet|AShortList|TriangleMesh')
    ;;
  *) echo "usage: scripts/test.sh [--ci | --full | --short]" >&2; exit 2 ;;
esac
stage set-up 3 scripts/bootstrap.sh --build
meanwhile rest
stage build 7 build
stage --show tests 4 tests
if [ "$tier" != short ]; then stage studies 2 studies; fi
print_budget
