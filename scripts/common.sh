# Sourced by the other scripts: the number of parallel jobs, and stages with time budgets.
#   JOBS                  default: number of cores, at most available memory / 1.5 GiB
#   CLOTHBENCH_CMAKE      further arguments of `cmake` when a build is configured, such as -DCMAKE_CXX_COMPILER=g++
# shellcheck shell=bash

default_jobs() {
  local cores by_memory
  cores=$(nproc)
  by_memory=$(awk '/^MemAvailable:/ { print int($2 / 1572864) }' /proc/meminfo 2>/dev/null || true)
  [ -n "$by_memory" ] && [ "$by_memory" -lt "$cores" ] && cores=$by_memory
  echo $((cores > 1 ? cores : 1))
}
export JOBS=${JOBS:-$(default_jobs)}

# configure PRESET [arguments of cmake…]: configures, the first time with clang, lld and as a unity build, which take the least time
configure() {
  local extra first=
  [ -f build/release/CMakeCache.txt ] || first='-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_UNITY_BUILD=ON -DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld'
  read -ra extra <<<"$first ${CLOTHBENCH_CMAKE:-}"
  cmake --preset "$@" "${extra[@]}"
}

# meanwhile COMMAND…: runs COMMAND in the background, for `build_targets` to wait for.
meanwhile() {
  rm -f "$stage_logs/meanwhile.status"
  { "$@" >"$stage_logs/meanwhile.log" 2>&1 && echo 0 >"$stage_logs/meanwhile.status" || echo $? >"$stage_logs/meanwhile.status"; } &
}
# build_targets PRESET TARGET…: first builds targets without the report's page, because npm, which bundles it, is still being installed.
build_targets() {
  cmake --build --preset "$1" -j "$JOBS" --target solvers/all harness/{assets,metrics,runner,scenario,truth}/all
  while [ ! -f "$stage_logs/meanwhile.status" ]; do sleep 0.2; done
  cat "$stage_logs/meanwhile.log"
  [ "$(cat "$stage_logs/meanwhile.status")" = 0 ]
  cmake --build --preset "$1" -j "$JOBS" --target "${@:2}"
}

budget_rows=()
over_budget=0
stage_logs=${CLOTHBENCH_LOGS:-build/log}
mkdir -p "$stage_logs"

# stage [--show] NAME LIMIT_MINUTES COMMAND…: runs COMMAND in a subshell with its output in a file (--show: also printed). Prints one line:
#   the time so far while it runs, then the total time. If it fails, prints the end of its output and the file's name.
stage() {
  local show=
  if [ "$1" = --show ]; then show=1; shift; fi
  local name=$1 limit=$(($2 * 60)) start=$SECONDS log status=0 ticker=
  log=$stage_logs/${name//[^A-Za-z0-9]/-}.log
  shift 2
  # Runs in a separate shell, not after `if` or `||`, which would ignore a failing command inside a function.
  set +e
  if [ -n "$show" ]; then
    echo "== $name (log: $log)"
    (set -euo pipefail; "$@") 2>&1 | tee "$log"
    status=${PIPESTATUS[0]}
  else
    stage_ticker "$name" "$start" "$log" &
    ticker=$!
    (set -euo pipefail; "$@") >"$log" 2>&1
    status=$?
    kill "$ticker" 2>/dev/null
    wait "$ticker" 2>/dev/null
  fi
  set -e
  local took=$((SECONDS - start)) note=
  if [ "$took" -gt "$limit" ]; then note=', over its budget'; fi
  if [ "$took" -gt $((limit * 3)) ]; then over_budget=1; fi
  stage_line "$name" "$took" "$([ "$status" -eq 0 ] && echo done || echo "failed, status $status")$note"
  [ -t 1 ] && echo
  budget_rows+=("$(printf '%-12s %5d s of %5d s%s' "$name" "$took" "$limit" "$note")")
  if [ "$status" -ne 0 ]; then
    [ -n "$show" ] || tail -30 "$log"
    echo "$name failed; its whole output: $log" >&2
  fi
  return "$status"
}

# On a terminal the line is overwritten; in a file, one line per minute shows that the stage is alive.
stage_line() {
  if [ -t 1 ]; then printf '\r%-12s %5d s  %s\e[K' "$1" "$2" "$3"; else printf '%-12s %5d s  %s\n' "$1" "$2" "$3"; fi
}
stage_ticker() {
  local pause=60 from=$SECONDS
  [ -t 1 ] && pause=1
  trap 'kill "${sleeping:-}" 2>/dev/null; exit' TERM
  while :; do
    sleep "$pause" &
    local sleeping=$!
    wait "$sleeping" || return
    stage_line "$1" $((SECONDS - from)) "$(tail -c 4000 "$3" 2>/dev/null | grep -oE '\[[0-9]+/[0-9]+\]' | tail -1 || true)"  # of ninja
  done
}

# side_by_side COMMAND…: runs all at the same time, each in its own process with `set -e`. If one fails, prints the end of its output again.
side_by_side() {
  local command processes=() k failed=()
  for command in "$@"; do
    (set -euo pipefail; "$command" 2>&1 | tee "$stage_logs/$command.log") &
    processes+=($!)
  done
  trap wait EXIT
  for k in "${!processes[@]}"; do wait "${processes[k]}" || failed+=("$stage_logs/${*:k + 1:1}.log"); done
  [ ${#failed[@]} -eq 0 ] || { tail -v -n 60 "${failed[@]}"; return 1; }
}

# Prints the time of every stage. With `enforce`, in CI, a stage that took three times its budget fails. The factor is this large
# because other work on the machine can double the time, which is no fault of the change.
print_budget() {
  echo
  echo "time used, of the budget on 2 cores (this run: $JOBS jobs; logs: $stage_logs):"
  printf '  %s\n' "${budget_rows[@]}"
  printf '  %-12s %5d s\n' together "$SECONDS"
  if [ "${1:-}" = enforce ] && [ "$over_budget" -ne 0 ] && [ "${CI:-}" = true ]; then
    echo "a stage took more than three times its budget" >&2
    return 1
  fi
}
