#!/usr/bin/env bash
# The full stability study in several calls: each stops after SECONDS, and the next continues there.
#   scripts/stability.sh OUT [SECONDS [SOLVER…]]    default: 520 s; xpbd and paper
# Exit status 0: complete, with its report in OUT/report; 75: call again. Nothing is timed, so JOBS processes run side by side; by default
# two fewer than there are cores.
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
124 | 130) echo "stopped after $seconds s; call again to continue"; exit 75 ;;
*) exit "$status" ;;
esac
