#!/usr/bin/env bash
# Downloads the room captures, hand meshes and hand poses pinned by assets-package-lock.json. Target: build/assets/node_modules in a source tree;
# for an installed program, the user's ~/.local/share/clothbench/assets/node_modules (below $XDG_DATA_HOME if set).
#   scripts/fetch-assets.sh [--require-assets]
# Without them clothbench uses procedural assets, so a failure prints one line and exits with 0; with --require-assets it exits with 1.
# Nothing from the packages is executed.
set -euo pipefail

require=0
case "${1:-}" in
  '') ;;
  --require-assets) require=1 ;;
  *) echo "usage: scripts/fetch-assets.sh [--require-assets]" >&2; exit 2 ;;
esac
here=$(cd "$(dirname "$0")" && pwd)
tree=$(dirname "$here")
if [ -f "$tree/CMakeLists.txt" ]; then
  target=$tree/build/assets
else
  target=${XDG_DATA_HOME:-${HOME:?}/.local/share}/clothbench/assets
fi

give_up() {
  echo "assets: $1; clothbench will use procedural rooms and hands"
  exit "$require"
}

# Written last, so that an interrupted fetch is repeated.
if cmp -s "$here/assets-package-lock.json" "$target/fetched-lock.json" && [ -d "$target/node_modules/@iwer/sem" ]; then
  echo "assets: already in $target"
  exit 0
fi

PATH=$PATH:$tree/build/npm  # where scripts/bootstrap.sh unpacks it
command -v npm >/dev/null || give_up "no npm (Debian: apt-get install npm)"

mkdir -p "$target"
rm -f "$target/fetched-lock.json"
cp "$here/assets-package.json" "$target/package.json"
cp "$here/assets-package-lock.json" "$target/package-lock.json"
log=$target/npm.log
(cd "$target" && timeout 420 npm ci --ignore-scripts --no-audit --no-fund --fetch-retries=1 --fetch-timeout=60000) >"$log" 2>&1 ||
  give_up "npm ci failed (see $log)"
cp "$here/assets-package-lock.json" "$target/fetched-lock.json"
echo "assets: fetched into $target"
