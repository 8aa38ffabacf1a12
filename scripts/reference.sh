#!/usr/bin/env bash
# The reference study: every published study by one program, part by part, into one folder; and the page that is published of it.
#   scripts/reference.sh OUT [--table gpu | software | quick] [--part NAME]... [--limit SECONDS] [--jobs N] [--second] [--resume] [--list]
#   scripts/reference.sh --pack OUT TO [PART…] | --report OUT... [--to FOLDER] | --add OUT... | --check [--to FOLDER]      see scripts/reference.py
# Parts, their expected seconds and what each runs: scripts/reference/parts.conf. Exit status 0: all parts are complete. 75: the limit
# (default 570 s) has come; the same call again continues, for finished runs and parts stay. 2: bad input. Else that of the part that failed.
# --second: names the parts second-table3 and so on, for another GPU: the page compares them with table3 and so on.
# Needs bash, coreutils, grep and clothbench with its scenarios and assets; no compiler, git or Python. CLOTHBENCH names the program
# (default: build/release/clothbench, else the one on PATH). Libraries of NvCloth and Jolt in build/peers or CLOTHBENCH_PLUGINS take part.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
python=${PYTHON:-/usr/bin/python3}
case ${1:-} in
  --report | --add | --check) exec "$python" "$here/scripts/reference.py" "$@" ;;
  --pack) exec "$python" "$here/scripts/reference/pack.py" "${@:2}" ;;
esac
fail() { echo "scripts/reference.sh: $*" >&2; exit 2; }
out= table=gpu limit=570 jobs=$(nproc) list=0 only=" " prefix=
while [ $# -gt 0 ]; do
  case $1 in
    --table | --part | --limit | --jobs)
      [ $# -gt 1 ] || fail "$1: expected a value"
      case $1 in --table) table=$2 ;; --part) only+="$2 " ;; --limit) limit=$2 ;; --jobs) jobs=$2 ;; esac
      shift ;;
    --resume) ;;  # what is there is always continued
    --list) list=1 ;;
    --second) prefix=second- ;;
    -*) fail "$1: expected --table, --part, --limit, --jobs, --second, --resume, --list, --pack, --report, --add or --check" ;;
    *) [ -z "$out" ] || fail "$1: expected one folder"; out=$1 ;;
  esac
  shift
done
[ -n "$out" ] || { sed -n '2,9s/^# //p' "$0" >&2; exit 2; }
for number in "$limit" "$jobs"; do [[ $number =~ ^[1-9][0-9]*$ ]] || fail "$number: expected a positive whole number"; done
bench=${CLOTHBENCH:-$here/build/release/clothbench}
[ -x "$bench" ] || bench=$(command -v clothbench) || fail "no program; CLOTHBENCH names it"
[ $list = 1 ] || mkdir -p "$out"
out=$(realpath -m "$out")
cd "$here"
version=$("$bench" --version)
# Two commits give one study if what may change a figure is the same in both (scripts/reference/measured_paths.txt).
sources() { sed 's/.*, sources \([0-9a-f]*\)$/\1/' <<<"$1"; }
[ ! -f "$out/version" ] || [ "$(sources "$(cat "$out/version")")" = "$(sources "$version")" ] ||
  fail "$out holds results of $(cat "$out/version"), this program is $version; a reference study has one state of the sources"

# Engines that users know, where their libraries are.
for library in build/peers/*/libclothbench_*.so; do
  [ ! -e "$library" ] || [[ ${CLOTHBENCH_PLUGINS:-} == *"$(basename "$library")"* ]] ||
    CLOTHBENCH_PLUGINS=${CLOTHBENCH_PLUGINS:+$CLOTHBENCH_PLUGINS:}$here/$library
done
export CLOTHBENCH_PLUGINS=${CLOTHBENCH_PLUGINS:-}
names=
for peer in nvcloth jolt; do [[ $CLOTHBENCH_PLUGINS != *"libclothbench_$peer.so"* ]] || names+="$peer "; done

# The command of a part, with its special words replaced, in `command`; the expression of RUNS in `pattern`.
read_command() {
  command=() pattern=
  local word peer
  for word in "$@"; do
    case $word in
      PEERS) for peer in $names; do command+=(--solver "$peer"); done ;;
      NAMES) for peer in $names; do command+=("$peer"); done ;;
      JOBS) command+=("$jobs") ;;
      RUNS=*) pattern=${word#RUNS=} ;;
      *) command+=("$word") ;;
    esac
  done
}
# Numbers of the runs whose names match.
chosen() { "$bench" "${command[@]}" --list-runs >"$out/.runs"; cut -f2 "$out/.runs" | grep -nP "$pattern" | cut -d: -f1 | while read -r n; do sed -n "${n}p" "$out/.runs" | cut -f1; done; rm "$out/.runs"; }

deadline=$((SECONDS + limit))
# run SECONDS-LEFT COMMAND…: interrupted at the limit, after which clothbench keeps what is finished.
one_run() { local left=$(($1 - $(date +%s))); shift; [ $left -gt 0 ] || return 124; timeout --foreground -s INT -k 30 "$left" "$@"; }
export -f one_run
part() {
  local name=$1 how=$2 status=0 start=$SECONDS until runs=()
  shift 2
  read_command "$@"
  until=$(($(date +%s) + deadline - SECONDS))
  if [ -n "$pattern" ]; then
    mapfile -t runs < <(chosen)
    [ ${#runs[@]} -gt 0 ] || fail "part $name: no run matches $pattern"
  fi
  local shown="${command[*]}${pattern:+ RUNS=$pattern}"
  command+=(--out "$out/$name")
  if [ "$how" = spread ]; then
    # A run that ends in a failure has a result. xargs ends at once, with 124, where one exits with 255, and with 123 where one failed.
    printf '%s\n' "${runs[@]}" | xargs -P "$jobs" -I N bash -c 'one_run "$@"; case $? in 0 | 1) ;; 124 | 130 | 137) exit 255 ;; *) exit 3 ;; esac' - "$until" "$bench" "${command[@]}" --run N \
      >>"$out/$name.log" 2>&1 || status=$?
  else
    [ ${#runs[@]} -eq 0 ] || command+=(--run "$(IFS=,; echo "${runs[*]}")")
    [ ${#runs[@]} -gt 0 ] || [ ! -d "$out/$name" ] || command+=(--resume)
    one_run "$until" "$bench" "${command[@]}" >>"$out/$name.log" 2>&1 || status=$?
  fi
  seconds=$((SECONDS - start + $(cat "$out/$name.seconds" 2>/dev/null || echo 0)))
  echo "$seconds" >"$out/$name.seconds"
  # Exit status 1: rows crashed, diverged or timed out, which are results.
  case $status in
    0 | 1) printf '%s\t%s\t%s\t%s\n' "$name" "$how" "$seconds" "$shown" >"$out/$name.done"; rm "$out/$name.seconds"; echo "$name: $seconds s" ;;
    124 | 130 | 137) echo "$name: stopped at the limit after $seconds s"; return 75 ;;
    *) tail -5 "$out/$name.log" >&2; echo "$name: exit status $status; all it wrote is in $out/$name.log" >&2; return "$status" ;;
  esac
}

grep -q "^$table " scripts/reference/parts.conf || fail "--table $table: expected gpu, software or quick"
for name in $only; do awk -v t="$table" -v n="$name" '$1 == t && $2 == n { found = 1 } END { exit !found }' scripts/reference/parts.conf || fail "--part $name: the table $table has no such part"; done
left=0 parts=()
while read -r in name expected how line; do
  [ "$in" = "$table" ] && [[ $only == " " || $only == *" $name "* ]] || continue
  [ ! -f "$out/$prefix$name.done" ] || continue
  [[ $name != *peers* ]] || [ -n "$names" ] || { echo "$name: left out, for build/peers has no library"; continue; }
  parts+=("$prefix$name"$'\t'"$how"$'\t'"$line")
  left=$((left + expected))
  echo "$name: $how, about $expected s"
done < <(grep -vE '^(#|$)' scripts/reference/parts.conf)
echo "to do: ${#parts[@]} parts, about $left s, in calls of at most $limit s; $version"
[ $list = 0 ] || exit 0
echo "$version" >"$out/version"
for each in "${parts[@]}"; do
  [ $SECONDS -lt $deadline ] || { echo "stopped at the limit; call again to continue"; exit 75; }
  IFS=$'\t' read -r name how line <<<"$each"
  read -ra words <<<"$line"
  part "$name" "$how" "${words[@]}" || { status=$?; [ $status -ne 75 ] || echo "call again to continue"; exit $status; }
done
echo "complete: $out"
