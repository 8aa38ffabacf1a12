#!/usr/bin/env bash
# How often `clothbench compare` reports a difference of a build from itself: five fresh processes per side, random order, 5 %.
#   tests/check/false_alarms.sh COMPARISONS [JOBS]
set -euo pipefail
bench=${CLOTHBENCH:-$(cd "$(dirname "$0")/../.." && pwd)/build/release/clothbench} home=$(mktemp -d)
trap 'rm -rf "$home"' EXIT
export bench home CLOTHBENCH_JOBS=1
compare_once() {
  local side process=0 folder=$home/$1
  for side in $(shuf -e a a a a a b b b b b); do
    "$bench" run paper/gravity --solver bullet-soft --set cloth.grid=[16,16] --set time.duration_s=0.2 --trials 3 --out "$folder/$side/$((process += 1))" >/dev/null
  done
  "$bench" compare "$folder/a" "$folder/b" --json | python3 -c "import json, sys; p = json.load(sys.stdin)['runs'][0]['time']['p']; assert 0 <= p <= 1; print(p)"
  rm -rf "$folder"
}
export -f compare_once
seq "$1" | xargs -P "${2:-1}" -I{} bash -c 'compare_once {}' | awk '{ n += $1 < 0.05 } END { print n, "of", NR }'
