#!/usr/bin/env bash
# Every study that the plugins of NvCloth and Jolt can run, with Bullet's soft body beside them, into OUT.
#   scripts/peers.sh --study OUT [timed | untimed] [--quick]
# timed: run it alone on the machine. untimed: its times are not used, so it may run beside other work. Without either, both.
# What is published of them comes from scripts/reference.sh.
# --quick: a few scenes, to see that all of it works. What is finished stays: call it again to continue. Each study prints
# the seconds that it took. Reports: OUT/report-<study>. Needs build/release/clothbench (or CLOTHBENCH) and build/peers (scripts/peers.sh DIR).
set -euo pipefail
out= quick= parts=
for word in "$@"; do
  case $word in
    --quick) quick=--quick ;;
    timed | untimed) parts="$parts $word" ;;
    -*) echo "scripts/peers.sh --study: $word: expected OUT, timed, untimed or --quick" >&2; exit 2 ;;
    *) out=$word ;;
  esac
done
[ -n "$out" ] || { echo "usage: scripts/peers.sh --study OUT [timed | untimed] [--quick]" >&2; exit 2; }
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$(dirname "$0")/.."
bench=${CLOTHBENCH:-build/release/clothbench}
for engine in nvcloth jolt; do
  plugin=$PWD/build/peers/$engine/libclothbench_$engine.so
  [ -e "$plugin" ] ||
    { echo "scripts/peers.sh --study: $plugin: not built; scripts/peers.sh DIR builds it" >&2; exit 1; }
  CLOTHBENCH_PLUGINS=${CLOTHBENCH_PLUGINS:+$CLOTHBENCH_PLUGINS:}$plugin
done
export CLOTHBENCH_PLUGINS
three=(--solver nvcloth --solver jolt --solver bullet-soft)

# part NAME COMMAND…: runs it with its folder as --out, once; a part that is interrupted continues there.
part() {
  local name=$1 start=$SECONDS resume=() status=0
  shift
  [ ! -e "$out/$name.done" ] || return 0
  [ ! -d "$out/$name" ] || resume=(--resume)
  "$bench" "$@" --out "$out/$name" "${resume[@]}" >"$out/$name.log" 2>&1 || status=$?
  # Exit status 1: rows crashed, diverged or timed out, which are results.
  if [ "$status" -gt 1 ]; then
    tail -5 "$out/$name.log" >&2
    return "$status"
  fi
  "$bench" report "$out/$name" -o "$out/report-$name" >"$out/report-$name.log" 2>&1 || { tail -5 "$out/report-$name.log" >&2; return 1; }
  echo "$name $((SECONDS - start)) s" | tee "$out/$name.done"
}

if [[ -z $parts || $parts == *" timed"* ]]; then
  part table3 study table3 ${quick:-"--short"} --trials 3 "${three[@]}"
  part hang study solvers/plugin/studies/peers-hang.json $quick
  part work-precision study work-precision ${quick:-"--short"} --trials 2 --no-moduli "${three[@]}"
fi
if [[ -z $parts || $parts == *untimed* ]]; then
  part friction friction nvcloth jolt bullet-soft
  part moduli moduli nvcloth jolt bullet-soft ${quick:+--no-sweep}
  part margins study solvers/plugin/studies/peers-margins.json $quick
  part stability study stability ${quick:-"--short"} --jobs 2 "${three[@]}"
  part penetration study penetration ${quick:-"--short"} --trials 1 "${three[@]}"
  part contact study contact $quick --seed 1 --count "$([ -n "$quick" ] && echo 2 || echo 108)" --jobs 2 "${three[@]}"
fi
