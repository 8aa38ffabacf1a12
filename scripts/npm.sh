#!/usr/bin/env bash
# Runs npm. If none is installed, downloads it from npm's registry into build/npm, because Debian's npm needs 480 further packages.
#   scripts/npm.sh ARGUMENTS…       npm_config_registry: another registry
set -euo pipefail
if command -v npm >/dev/null; then exec npm "$@"; fi

version=10.9.4  # runs on Node 18, which Debian 12 has
sha512=3a7506f37e85c1ba1021baad79f0cd9724748131f321fc117c4dc3ba235ec01be7327584a41d15117c01945560aa9373220628fcc1e1dddd877a5fe9b336a900
folder=$(realpath -m "$(dirname "$0")/../build/npm/$version")
if [ ! -d "$folder" ]; then
  mkdir -p "$(dirname "$folder")"
  unpacked=$(mktemp -d "$folder.XXXXXX")
  trap 'rm -rf "$unpacked"' EXIT
  /usr/bin/python3 - "${npm_config_registry:-https://registry.npmjs.org}" $version $sha512 "$unpacked" <<'END'
import hashlib, io, sys, tarfile, urllib.request
registry, version, sha512, folder = sys.argv[1:]
url = f"{registry.rstrip('/')}/npm/-/npm-{version}.tgz"
try:
    archive = urllib.request.urlopen(url, timeout=60).read()
except OSError as error:
    sys.exit(f"npm: {url}: {error}")
if hashlib.sha512(archive).hexdigest() != sha512:
    sys.exit(f"npm: {url}: its SHA-512 is not {sha512[:16]}…")
tarfile.open(fileobj=io.BytesIO(archive)).extractall(folder)
END
  mv -T "$unpacked" "$folder" 2>/dev/null || [ -d "$folder" ]  # another process may have been faster
fi
exec node "$folder/package/bin/npm-cli.js" "$@"
