# Sourced: `stage NAME LIMIT_MINUTES COMMAND...` runs a stage and notes its time; `print_budget` shows all of them.
budget_rows=()
stage() {
  local name=$1 limit=$2 start=$SECONDS
  shift 2
  local status=0
  "$@" || status=$?
  budget_rows+=("$(printf '%-10s %4d s of %4d s' "$name" $((SECONDS - start)) $((limit * 60)))")
  return $status
}
print_budget() {
  echo
  echo "time used, of the budget on 2 cores:"
  printf '  %s\n' "${budget_rows[@]}"
}
