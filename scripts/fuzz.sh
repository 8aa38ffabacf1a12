#!/usr/bin/env bash
# Fuzzes every reader of foreign files for some seconds each, JOBS at a time, with address and undefined-behaviour sanitizers.
#   scripts/fuzz.sh [seconds] [reader...]     default: 10 s, all readers; new inputs go to build/fuzz/found
# SEED=N repeats the inputs of an earlier run as far as time allows; by default, inputs differ in every run.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/common.sh
seconds=${1:-10}
readers=(scene obj gltf room hand track part hdf5)
[ $# -gt 1 ] && readers=("${@:2}")
cmake --preset sanitize >build/configure-sanitize.log 2>&1 || { tail -30 build/configure-sanitize.log; exit 1; }
cmake --build --preset sanitize -j "$JOBS" --target fuzz >build/fuzz.log 2>&1 || { tail -30 build/fuzz.log; exit 1; }

fuzz() {
  local reader=$1 found=build/fuzz/found/$1 log=build/fuzz/$1.log dictionary=()
  mkdir -p "$found"
  [ -f "tests/fuzz/$reader.dict" ] && dictionary=(-dict="tests/fuzz/$reader.dict")
  if ! READER=$reader build/sanitize/fuzz -seed="${SEED:-0}" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/$reader-" "${dictionary[@]}" "$found" "tests/fuzz/corpus/$reader" >"$log" 2>&1; then
    grep -E "ERROR|SUMMARY|runtime error|terminate|what\(\)" "$log" | head -5
    echo "fuzz: $reader: a finding (build/fuzz/$reader-*; $log)" >&2
    return 1
  fi
  echo "fuzz: $reader: $(grep -o 'stat::number_of_executed_units: *[0-9]*' "$log" | grep -o '[0-9]*$') inputs in $seconds s, $(grep -oE 'cov: [0-9]+' "$log" | tail -1 | cut -d' ' -f2) edges, none crashed"
}

export -f fuzz
export seconds
printf '%s\n' "${readers[@]}" | xargs -P "$JOBS" -I{} bash -euo pipefail -c 'fuzz {}'
