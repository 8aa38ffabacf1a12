#!/usr/bin/env bash
# Runs the published studies one after another into OUT, and makes the published files from them.
#   scripts/publish.sh OUT [--table gpu | software | peers | quick] [--only STUDY]... [--limit SECONDS] [--jobs N] [--device N]
#   scripts/publish.sh --report OUT... [--to FOLDER] [--archive FILE.tar.xz] [--jobs N]
# First form, exit status: 0: all studies of the table are complete. 75: the limit (default 570 s) was reached; call it again: complete studies
# are skipped, finished runs stay. 2: bad input. Otherwise the status of the study that failed.
# Second form: writes one report per study, one page for all studies, and SHA256SUMS into FOLDER (default results/reference/h200), from OUT of
# one state of the sources. --archive also packs raw results, commands and RESULTS.SHA256; the file's suffix selects the compression.
# Needs clothbench with its scenarios and assets, bash and coreutils; no compiler, git or Python. CLOTHBENCH: the program (default:
# build/release/clothbench, otherwise the one on PATH). Engines in build/peers are included.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)

# Columns: table (where the study runs); name (studies with equal names before "+" share a report); command of clothbench without --out.
# PEERS: --solver for each engine in build/peers. JOBS: for --jobs. SEED: from the commit's hash, so that nobody can choose scenes in favour of a solver.
studies() {
  cat <<'END'
gpu       table3            study table3 --jobs JOBS --solver paper --solver xpbd --solver bullet-soft --solver ballistic PEERS
gpu       hang              study hang --solver xpbd --solver paper --solver bullet-soft PEERS --jobs JOBS
gpu       work-precision    study work-precision --solver paper --solver xpbd --solver bullet-soft --solver bullet-deformable --solver reference PEERS --jobs JOBS
gpu       convergence       study convergence --solver paper --solver xpbd --solver bullet-soft PEERS --jobs JOBS
gpu       penetration       study penetration --require-assets --solver xpbd --solver paper --solver bullet-soft --solver ballistic PEERS --jobs JOBS
gpu       reproduction      study reproduction --jobs JOBS
gpu       physics           study physics --seed SEED --count 300 --solver xpbd --jobs JOBS
gpu       contact           study contact --seed SEED --count 200 --solver xpbd --jobs JOBS
gpu       scale             study scale --jobs JOBS
gpu       many-cloths       study many-cloths --solver xpbd --solver bullet-soft PEERS --jobs JOBS
gpu       meshes            run garments/sleeve garments/t-shirt garments/skirt garments/tablecloth --solver xpbd --trials 5
software  friction          study friction --trials 1 --solver xpbd --solver paper --solver bullet-soft PEERS --jobs JOBS
software  moduli            study moduli --trials 1 --solver xpbd --solver paper --solver bullet-soft --solver bullet-deformable PEERS --jobs JOBS
software  energy            study energy --seed SEED --count 200 --jobs JOBS
software  physics+others    study physics --seed SEED --count 80 --solver paper --solver bullet-soft --solver bullet-deformable PEERS --jobs JOBS
software  contact+others    study contact --seed SEED --count 200 --solver paper --solver bullet-soft PEERS --jobs JOBS
software  reproduction+software study reproduction --seed 7 --count 6
software  stability         study stability --solver xpbd --solver paper PEERS --jobs JOBS
peers     peers-margins     study solvers/plugin/studies/peers-margins.json
peers     mujoco-ball       study solvers/plugin/studies/mujoco-ball.json
quick     table3            study table3 --quick --trials 2
quick     hang              study hang --quick --trials 1
END
}

fail() { echo "scripts/publish.sh: $*" >&2; exit 2; }
bench=${CLOTHBENCH:-$here/build/release/clothbench}
[ -x "$bench" ] || bench=$(command -v clothbench) || fail "no clothbench found; set CLOTHBENCH to its path"
folders=() to=$here/results/reference/h200 table=gpu only=' ' limit=570 jobs=$(nproc) report='' archive='' device=()
while [ $# -gt 0 ]; do
  case $1 in
    --report) report=1 ;;
    --to | --archive | --table | --only | --limit | --jobs | --device)
      [ $# -gt 1 ] || fail "$1: expected a value"
      case $1 in --to) to=$2 ;; --archive) archive=$(realpath -m "$2") ;; --table) table=$2 ;; --only) only+="$2 " ;; --limit) limit=$2 ;; --jobs) jobs=$2 ;; --device) device=(--device "$2") ;; esac
      shift ;;
    -*) fail "$1: expected --table, --only, --limit, --jobs, --device, --report, --to or --archive" ;;
    *) folders+=("$(realpath -m "$1")") ;;
  esac
  shift
done
[ ${#folders[@]} -gt 0 ] || { sed -n '2,10s/^# //p' "$0" >&2; exit 2; }
for number in "$limit" "$jobs"; do [[ $number =~ ^[1-9][0-9]*$ ]] || fail "$number: expected a positive whole number"; done
to=$(realpath -m "$to") out=${folders[0]}
cd "$here"
export __GL_SHADER_DISK_CACHE=1  # for root, NVIDIA's driver otherwise compiles all shaders again in each process: up to 18 s
sources() { sed 's/.*, sources //' "$1"; }

if [ -n "$report" ]; then
  for folder in "${folders[@]}"; do
    [ -f "$folder/version" ] || fail "$folder: no file \"version\" in it; scripts/publish.sh OUT makes such folders"
    [ "$(sources "$folder/version")" = "$(sources "$out/version")" ] || fail "$folder and $out come from different sources"
  done
  mapfile -t complete < <(find "${folders[@]}" -maxdepth 1 -name '*.done' | sort)
  [ ${#complete[@]} -gt 0 ] || fail "$out: no complete study"
  mapfile -t names < <(basename -a "${complete[@]%.done}" | sed 's/+.*//' | sort -u)
  rm -rf "$to" && mkdir -p "$to"
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
  one_report() {
    local name=$1 file parts=() figures
    for file in "${complete[@]}"; do [ "$(basename "${file%.done}" | sed 's/+.*//')" != "$name" ] || parts+=("${file%.done}"); done
    "$bench" report "${parts[@]}" -o "$scratch/$name" >"$scratch/$name.log" || { tail -5 "$scratch/$name.log" >&2; exit 1; }
    mkdir "$to/$name"
    cp "$scratch/$name/report.md" "$to/$name"
    xz -9 <"$scratch/$name/runs.csv" >"$to/$name/runs.csv.xz"
    mapfile -t figures < <(find "$scratch/$name" -name '*-wide.svg')
    [ ${#figures[@]} -eq 0 ] || { mkdir "$to/$name/figures" && cp "${figures[@]}" "$to/$name/figures"; }
  }
  history=()
  [ ! -f results/history.jsonl ] || history=(--history results/history.jsonl)
  "$bench" report "${complete[@]%.done}" -o "$scratch/all" "${history[@]}" >/dev/null &
  processes=($!)
  for name in "${names[@]}"; do
    while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do sleep 0.2; done
    one_report "$name" &
    processes+=($!)
  done
  for process in "${processes[@]}"; do wait "$process"; done
  cp "$scratch/all/index.html" "$to"
  # The commands, their times in seconds, and the hashes of all raw results and all published files.
  { printf 'study\tseconds\tcommand\n'; cat "${complete[@]}"; } >"$to/commands.tsv"
  for file in "${complete[@]%.done}"; do (cd "$(dirname "$file")" && find "$(basename "$file")" -name '*.h5' -exec sha256sum {} +); done | sort -k2 >"$to/RESULTS.SHA256"
  (cd "$to" && find . -type f ! -name SHA256SUMS -printf '%P\n' | sort | xargs -d '\n' sha256sum >"$scratch/sums" && cp "$scratch/sums" SHA256SUMS)
  if [ -n "$archive" ]; then
    members=(-C "$to" RESULTS.SHA256 commands.tsv)
    for file in "${complete[@]%.done}"; do members+=(-C "$(realpath "$(dirname "$file")")" "$(basename "$file")"); done
    tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -caf "$archive" "${members[@]}"  # equal results give an equal archive
    sha256sum "$archive"
  fi
  echo "$to: ${#names[@]} studies; $(wc -l <"$to/RESULTS.SHA256") result files"
  exit
fi

[ ${#folders[@]} -eq 1 ] || fail "expected one folder"
studies | grep -q "^$table " || fail "--table $table: expected gpu, software, peers or quick"
for name in $only; do studies | sed 's/  */ /g' | grep -qF "$table $name " || fail "--only $name: the table $table has no such study"; done
if [ "$table" != quick ] && "$bench" list assets | grep -q '^procedural'; then fail "rooms and hands are missing: scripts/fetch-assets.sh fetches them"; fi
mkdir -p "$out"
"$bench" --version >"$out/version.now"
[ ! -f "$out/version" ] || [ "$(sources "$out/version")" = "$(sources "$out/version.now")" ] ||
  fail "$out has results of $(cat "$out/version"), but this program is $(cat "$out/version.now"); publish results of one state of the sources"
mv "$out/version.now" "$out/version"
commit=$(sed -n 's/.*(\([0-9a-f]\{1,6\}\).*/\1/p' "$out/version")
seed=$((16#${commit:-1}))
names=()
for library in build/peers/*/libclothbench_*.so; do
  [ -e "$library" ] || continue
  names+=("$(basename "$library" .so | sed 's/libclothbench_//; s/_/-/')")
  CLOTHBENCH_PLUGINS=${CLOTHBENCH_PLUGINS:+$CLOTHBENCH_PLUGINS:}$here/$library
done
export CLOTHBENCH_PLUGINS=${CLOTHBENCH_PLUGINS:-}
[ "$table" != peers ] || [ ${#names[@]} -gt 0 ] || fail "--table peers: build/peers has no library"

deadline=$((SECONDS + limit))
while read -r in name line; do
  if [ "$in" != "$table" ] || [[ $only != ' ' && $only != *" $name "* ]] || [ -f "$out/$name.done" ]; then continue; fi
  read -ra words <<<"$(sed "s/JOBS/$jobs/; s/SEED/$seed/" <<<"$line")"
  command=()
  for word in "${words[@]}"; do
    case $word in
      PEERS) for peer in "${names[@]}"; do command+=(--solver "$peer"); done ;;
      *) command+=("$word") ;;
    esac
  done
  resume=() status=124 start=$SECONDS
  [ ! -d "$out/$name" ] || resume=(--resume)
  # At the limit clothbench is interrupted and keeps finished runs. Exit status 1 (runs crashed, diverged or timed out) is also a result.
  left=$((deadline - SECONDS))
  [ $left -le 0 ] || { status=0; timeout --foreground -s INT -k 30 "$left" "$bench" "${command[@]}" "${device[@]}" --out "$out/$name" "${resume[@]}" </dev/null >>"$out/$name.log" 2>&1 || status=$?; }
  seconds=$((SECONDS - start + $(cat "$out/$name.seconds" 2>/dev/null || echo 0)))
  echo $seconds >"$out/$name.seconds"
  case $status in
    0 | 1) printf '%s\t%s\t%s\n' "$name" $seconds "clothbench ${command[*]}" >"$out/$name.done"; echo "$name: $seconds s" ;;
    124 | 130 | 137) echo "$name: stopped at the limit after $seconds s; call again to continue"; exit 75 ;;
    *) tail -5 "$out/$name.log" >&2; echo "$name: exit status $status; its whole output: $out/$name.log" >&2; exit $status ;;
  esac
done < <(studies)
echo "$out: all studies of the table $table are complete"
