#!/usr/bin/env bash
# Runs both README commands on a bare Debian 13 as a newcomer would: a chroot made by debootstrap, a clone of the committed HEAD, one
# build by clang with warnings as errors, the quick study, a short set of tests, a live session on Monado's OpenXR runtime, the Debian
# package, and that package installed in a second bare Debian 13.
#   scripts/debian13.sh [--prepare | --keep] [--suite trixie | bookworm] [FOLDER]     default: build/debian13; only the bare system and
#                                                                                     downloads in it are kept
# --prepare: only makes the system and installs packages, which mostly waits for network and disk.
# --keep: continues with the system of the last call, at the current HEAD.
# --suite bookworm: on a bare Debian 12, with its own compiler and without Monado, which it lacks; FOLDER: build/bookworm.
# Needs root (chroot). Without root the stage is skipped with a message, unless CLOTHBENCH_REQUIRE_DEBIAN13=1.
set -euo pipefail
cd "$(dirname "$0")/.."
usage() { echo "usage: scripts/debian13.sh [--prepare | --keep] [--suite trixie | bookworm] [FOLDER]" >&2; exit 2; }
keep='' prepare='' suite=trixie name=debian13
while [ $# -gt 0 ]; do
  case $1 in
    --keep) keep=1 ;;
    --prepare) prepare=1 ;;
    --suite)
      case ${2:-} in trixie) ;; bookworm) suite=bookworm name=bookworm ;; *) usage ;; esac
      shift ;;
    -*) usage ;;
    *) break ;;
  esac
  shift
done
folder=$(realpath -m "${1:-build/$name}")
# Separate logs, named after the outer stage.
CLOTHBENCH_LOGS=${CLOTHBENCH_LOGS:-build/log}/$name
source scripts/common.sh
here=$PWD

skip() {
  if [ "${CLOTHBENCH_REQUIRE_DEBIAN13:-}" = 1 ]; then
    echo "$name: $1, and CLOTHBENCH_REQUIRE_DEBIAN13=1" >&2
    exit 1
  fi
  echo "$name: SKIPPED: $1"
  echo "0 passed, 0 failed, 1 skipped"
  exit 0
}
[ "$(id -u)" -eq 0 ] || skip "not root"
unshare --mount true 2>/dev/null || skip "no mount namespaces here"

bare() {
  command -v debootstrap >/dev/null ||
    { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap; } || return 1
  if [ ! -f "$folder/base/.complete" ]; then
    rm -rf "$folder/base"
    mkdir -p "$folder/base"
    # The Debian mirror of this machine; security updates come from another one.
    local mirror
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' |
      grep -v -- '-security$' | cut -d' ' -f1 | sort -u | head -1)
    [ -n "$mirror" ] || { echo "apt knows no Debian mirror (run apt-get update once)"; return 1; }
    debootstrap --variant=minbase "$suite" "$folder/base" "$mirror" || return 1
    rm -f "$folder/base"/var/cache/apt/archives/*.deb
    # Nothing here outlives the test, so dpkg need not sync the disk.
    echo force-unsafe-io >"$folder/base/etc/dpkg/dpkg.cfg.d/unsafe-io"
    touch "$folder/base/.complete"
  fi
  cp /etc/resolv.conf "$folder/base/etc/resolv.conf"
  local certificates=${NODE_EXTRA_CA_CERTS:-${SSL_CERT_FILE:-}}
  [ -z "$certificates" ] || install -D -m 644 "$certificates" "$folder/base/etc/ssl/machine.crt"
  if [ -n "$keep" ] && [ -d "$folder/build/root/clothbench" ]; then
    git -C "$folder/build/root/clothbench" fetch -q origin
    git -C "$folder/build/root/clothbench" checkout -q --detach "$(git rev-parse HEAD)"
    rm -rf "$folder/installed"
    return
  fi
  # Copies from earlier runs contain no mounts: mounts are in a separate namespace.
  rm -rf "$folder/build" "$folder/installed"
  cp -a "$folder/base" "$folder/build"
  cp -a "$folder/base" "$folder/installed"
  mkdir -p "$folder/archives" "$folder/ccache" "$folder/build/root/.cache/ccache"
  git clone -q "file://$here" "$folder/build/root/clothbench"
  git -C "$folder/build/root/clothbench" checkout -q --detach "$(git rev-parse HEAD)"
}

# in_chroot ROOT COMMAND: runs COMMAND as root after a fresh login, with this machine's network access.
in_chroot() {
  local root=$1 variables=(HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8
    DEBIAN_FRONTEND=noninteractive "JOBS=$JOBS")
  local name
  for name in http_proxy https_proxy no_proxy; do [ -z "${!name:-}" ] || variables+=("$name=${!name}"); done
  [ ! -f "$root/etc/ssl/machine.crt" ] || variables+=(NODE_EXTRA_CA_CERTS=/etc/ssl/machine.crt npm_config_cafile=/etc/ssl/machine.crt)
  unshare --mount bash -euc '
    root=$1 folder=$2
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount --bind "$folder/archives" "$root/var/cache/apt/archives"
    [ ! -d "$root/root/.cache/ccache" ] || mount --bind "$folder/ccache" "$root/root/.cache/ccache"
    shift 2
    exec chroot "$root" env -i "$@"' bash "$root" "$folder" "${variables[@]}" bash -euc "cd /root; [ ! -d clothbench ] || cd clothbench; $2"
}
newcomer() { in_chroot "$folder/build" "$1"; }

set_up() {
  newcomer 'rm -f /etc/apt/apt.conf.d/docker-clean; apt-get update; apt-get install -y --no-install-recommends git ca-certificates
            git config --global --add safe.directory "*"; scripts/bootstrap.sh --short'
}
# Without optimisation, which halves the compile time; no speed is measured here.
options='-DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-DNDEBUG'
[ "$suite" != trixie ] || options+=' -DCLOTHBENCH_WERROR=ON'
compiler="export CLOTHBENCH_CMAKE='$options'"
monado() {
  newcomer 'apt-get install -y --no-install-recommends monado-service libopenxr1-monado openxr-layer-corevalidation python3-h5py
            /usr/bin/python3 tests/xr/check_monado.py build/release/clothbench'
}
package() {
  newcomer 'apt-get install -y --no-install-recommends dpkg-dev file
            cpack --config build/release/CPackConfig.cmake -G "DEB;TGZ" -B build/packages'
  rm -rf "$folder/packages"
  cp -r "$folder/build/root/clothbench/build/packages" "$folder/packages"
}
installed() {
  [ -d "$folder/installed" ] || cp -a "$folder/base" "$folder/installed"
  scripts/package_test.sh "$folder"/packages/*.deb "$folder/installed"
}

stage bare 3 bare
stage set-up 4 set_up
[ -z "$prepare" ] || exit 0
stage --show run.sh 6 newcomer "$compiler; scripts/run.sh --quick"
stage package 2 package
stage --show test.sh 5 newcomer "$compiler; scripts/test.sh --short"
if [ "$suite" = trixie ]; then
  stage --show 'monado, installed' 3 side_by_side monado installed
else
  stage --show installed 3 installed
fi
print_budget enforce
