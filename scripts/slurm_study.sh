#!/bin/sh
# usage: scripts/slurm_study.sh STUDY OUT [options of `clothbench study`, such as --solver xpbd]
# Each run becomes one task of a Slurm array; all tasks write into the folder OUT on a file system that the nodes share. A second job does the
# steps that need all runs, and writes a report to OUT/report. $CLOTHBENCH: the program (default: clothbench on PATH, otherwise this tree's
# build). $SBATCH_…: Slurm's own defaults, such as SBATCH_PARTITION. Prints the numbers of both jobs.
set -eu
[ $# -ge 2 ] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
study=$1 out=$2
shift 2
here=$(cd "$(dirname "$0")/.." && pwd)
program=${CLOTHBENCH:-$(command -v clothbench || echo "$here/build/release/clothbench")}
mkdir -p "$out/log"
runs=$("$program" study "$study" "$@" --list-jobs | wc -l)
words=$(for word in "$@"; do printf " '%s'" "$(printf %s "$word" | sed "s/'/'\\\\''/g")"; done)
# Exclusive, because other work on the node would affect the times.
array=$(sbatch --parsable --exclusive --requeue --array="0-$((runs - 1))" --job-name="clothbench-$study" --output="$out/log/run-%a.txt" \
  --wrap="'$program' study '$study'$words --out '$out' --job \$SLURM_ARRAY_TASK_ID")
after=$(sbatch --parsable --dependency="afterany:$array" --job-name="clothbench-report" --output="$out/log/report.txt" \
  --wrap="'$program' study '$study'$words --out '$out' --resume; '$program' report '$out' -o '$out/report'")
echo "$array $after"
