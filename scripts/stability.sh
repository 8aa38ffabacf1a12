#!/usr/bin/env bash
# The full stability study, in as many calls as it takes: each stops by itself, the next goes on where it stopped.
#   scripts/stability.sh OUT [SECONDS [SOLVER…]]    default: 520 s; xpbd and paper
# Exit status 0: all there, with its report in OUT/report; 75: call again. Nothing is timed, so processes run side by side: JOBS, by default
# one a core but two.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:?folder for the results}
seconds=${2:-520}
shift $(($# < 2 ? $# : 2))
[ $# -gt 0 ] || set -- xpbd paper
jobs=${JOBS:-$(($(nproc) > 3 ? $(nproc) - 2 : 1))}
flags=(--full --jobs "$jobs" --out "$out")
for solver in "$@"; do flags+=(--solver "$solver"); done
[ ! -d "$out" ] || flags+=(--resume)
status=0
mkdir -p "$(dirname "$out")"
timeout --foreground -s INT "$seconds" build/release/clothbench study stability "${flags[@]}" >"$out.log" 2>&1 || status=$?
tail -1 "$out.log"
case $status in
0) build/release/clothbench report "$out" -o "$out/report" ;;
124 | 130) echo "stopped after $seconds s: call again"; exit 75 ;;
*) exit "$status" ;;
esac
