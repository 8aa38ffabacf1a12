#!/usr/bin/env bash
# Builds the plugins of NvCloth and Jolt from checkouts below DIR and holds them to clothbench's conformance.
#   scripts/peers.sh DIR [nvcloth | jolt]
# DIR/NvCloth and DIR/JoltPhysics are used as they are, and a line says if one is not at the commit named here; a missing
# one is cloned at that commit from NVCLOTH_URL or JOLT_URL (default: GitHub). Plugins: build/peers. Needs git, CMake and, for
# conformance, build/release/clothbench (scripts/run.sh builds it). JOBS: see scripts/common.sh.
set -euo pipefail
case "${1:-}" in
  '' | -*) echo "usage: scripts/peers.sh DIR [nvcloth | jolt]" >&2; exit 2 ;;
esac
mkdir -p "$1"
dir=$(cd "$1" && pwd)
shift
[ $# -gt 0 ] || set -- nvcloth jolt
cd "$(dirname "$0")/.."
source scripts/common.sh

nvcloth_commit=6e86b1838ae185c527744d475d34777ff69c1b8a # master of January 2024: 1.1.6 without its package manager
jolt_commit=23dadd0e603f1b321142d4c74df07fce85064989    # v5.5.0
nvcloth_url=${NVCLOTH_URL:-https://github.com/NVIDIAGameWorks/NvCloth.git}
jolt_url=${JOLT_URL:-https://github.com/jrouwe/JoltPhysics.git}

# checkout FOLDER URL COMMIT PATTERN…: of a new clone only the files that the patterns choose.
checkout() {
  local folder=$1 url=$2 commit=$3 now
  shift 3
  if [ -d "$folder" ]; then
    now=$(git -C "$folder" rev-parse HEAD 2>/dev/null || echo none)
    [ "$now" = "$commit" ] || echo "$folder: at commit $now; the figures in solvers/plugin/PEERS.md are of $commit"
    return
  fi
  git clone --quiet --no-checkout --filter=blob:none "$url" "$folder"
  git -C "$folder" sparse-checkout set --no-cone "$@"
  git -C "$folder" checkout --quiet "$commit"
}

for engine in "$@"; do
  case $engine in
    nvcloth)
      root=$dir/NvCloth
      checkout "$root" "$nvcloth_url" "$nvcloth_commit" '/NvCloth/include/' '/NvCloth/src/*' '!/NvCloth/src/cuda/' \
        '!/NvCloth/src/dx/' '/NvCloth/extensions/' '/NvCloth/license.txt' '/PxShared/'
      variable=NVCLOTH_ROOT
      ;;
    jolt)
      root=$dir/JoltPhysics
      checkout "$root" "$jolt_url" "$jolt_commit" '/Jolt/' '/Build/*' '/LICENSE'
      variable=JOLT_ROOT
      ;;
    *) echo "scripts/peers.sh: $engine: expected nvcloth or jolt" >&2; exit 2 ;;
  esac
  cmake -S "solvers/plugin/$engine" -B "build/peers/$engine" "-D$variable=$root" >/dev/null
  cmake --build "build/peers/$engine" -j "$JOBS" --target "clothbench_$engine" >"build/peers/$engine.log" ||
    { tail -20 "build/peers/$engine.log" >&2; exit 1; }
  plugin=build/peers/$engine/libclothbench_$engine.so
  echo "built: $plugin"
  if [ -x build/release/clothbench ]; then
    build/release/clothbench conformance "plugin:$plugin"
  else
    echo "conformance: not run, there is no build/release/clothbench (scripts/run.sh builds it)"
  fi
done
