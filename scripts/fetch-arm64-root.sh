#!/usr/bin/env bash
# Unpacks Debian's arm64 packages (libraries for the arm64-linux build, and a Vulkan driver to run it with) into a folder.
# Installs nothing and leaves the machine's apt state unchanged. Does nothing if they are already there.
#   scripts/fetch-arm64-root.sh [FOLDER]     default build/arm64-root
set -euo pipefail
cd "$(dirname "$0")/.."
root=$(realpath -m "${1:-build/arm64-root}")
packages=(libstdc++6 libvulkan1 libvulkan-dev mesa-vulkan-drivers libbullet-dev libfmt-dev libopenxr-loader1)
stamp="$root/.complete"
wanted=$(printf '%s\n' "${packages[@]}")
if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$wanted" ]; then
  echo "arm64 packages: $root is complete"
  exit 0
fi
rm -rf "$root"
state="$root.apt"
mkdir -p "$root" "$state"/{lists/partial,cache/archives/partial}
: >"$state/status"
# The Debian mirrors of this machine.
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
signed=""
[ -f "$keyring" ] && signed="[signed-by=$keyring] "
mirrors() {
  apt-get indextargets --format "deb $signed\$(REPO_URI) \$(RELEASE) \$(COMPONENT)" 'Created-By: Packages' 'Origin: Debian' |
    sort -u >"$state/sources.list"
}
mirrors
# A fresh image may lack package lists.
if [ ! -s "$state/sources.list" ] && [ "$(id -u)" -eq 0 ]; then
  apt-get update >/dev/null 2>&1 || true
  mirrors
fi
if [ ! -s "$state/sources.list" ]; then
  echo "arm64 packages: apt knows no Debian mirror (is this Debian? then run apt-get update once)" >&2
  exit 1
fi
options=(-o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State=$state" -o "Dir::State::lists=$state/lists"
         -o "Dir::State::status=$state/status" -o "Dir::Cache=$state/cache" -o "Dir::Etc::SourceList=$state/sources.list"
         -o Dir::Etc::SourceParts=- -o Dir::Etc::Preferences=- -o Dir::Etc::PreferencesParts=- -o APT::Sandbox::User=
         -o Debug::NoLocking=1 -o APT::Install-Recommends=false -o APT::Update::Post-Invoke::= -o DPkg::Post-Invoke::=)
log="$state/log"
if ! { apt-get "${options[@]}" update && apt-get "${options[@]}" -y --download-only install "${packages[@]}"; } >"$log" 2>&1; then
  tail -15 "$log" >&2
  echo "arm64 packages: apt-get failed (whole output: $log)" >&2
  exit 1
fi
for package in "$state"/cache/archives/*.deb; do dpkg -x "$package" "$root"; done
# The driver file contains the absolute path of an installed system.
sed -i -E "s|\"library_path\": *\"([^\"]*/)?|\"library_path\": \"$root/usr/lib/aarch64-linux-gnu/|" "$root"/usr/share/vulkan/icd.d/lvp_icd*.json
# Links to absolute paths would point outside the folder.
find "$root" -type l -lname '/*' -print0 | while IFS= read -r -d '' link; do
  ln -sfn "$root$(readlink "$link")" "$link"
done
rm -rf "$state"
printf '%s\n' "${packages[@]}" >"$stamp"
echo "arm64 packages: $root ($(du -sm "$root" | cut -f1) MB)"
