#!/usr/bin/env bash
# Checks that the Debian package is complete: installs it into a bare system and works there as a new user would.
#   scripts/package_test.sh CLOTHBENCH.deb CHROOT
# CHROOT: a bare Debian of the release for which the package was made (debootstrap --variant=minbase), without build packages; it is
# changed. Needs root, and the chroot's own apt sources.
set -euo pipefail

[ $# -eq 2 ] || { sed -n '3,5s/^# *//p' "$0" >&2; exit 2; }
deb=$(realpath "$1") root=$(realpath "$2")
[ -f "$deb" ] || { echo "package: $deb: expected a .deb" >&2; exit 2; }
[ -x "$root/usr/bin/apt-get" ] || { echo "package: $root: expected a folder made by debootstrap" >&2; exit 2; }
if [ -z "${PACKAGE_TEST_OWN_MOUNTS:-}" ]; then
  # Mounts in a separate namespace disappear with the namespace, however this script ends.
  PACKAGE_TEST_OWN_MOUNTS=1 exec unshare --mount "$0" "$deb" "$root"
fi
mount -t proc proc "$root/proc"
mount --rbind /dev "$root/dev"

home=/home/clothbench-test
as_root() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
# A user who is not root and cannot write into /usr.
as_user() { chroot --userspec=65534:65534 "$root" /usr/bin/env -i -C $home PATH=/usr/bin:/bin HOME=$home LC_ALL=C.UTF-8 "$@"; }
fail() { echo "package: $*" >&2; exit 1; }
ok() { echo "package: $*"; }
quietly() { "$@" >"$root/tmp/log" 2>&1 || { tail -20 "$root/tmp/log" >&2; fail "failed: $*"; }; }
get() { quietly as_root apt-get install -y --no-install-recommends "$@"; }

install_it() {
  ! as_root dpkg -s clothbench >/dev/null 2>&1 || fail "$root: clothbench is installed there already: expected a bare system"
  cp "$deb" "$root/tmp/clothbench.deb"
  quietly as_root apt-get update
  get /tmp/clothbench.deb
  rm "$root/tmp/clothbench.deb"
  as_root dpkg -s clothbench | grep -q '^Recommends:.*\bnodejs\b' || fail "it does not recommend nodejs"
  for name in nodejs librsvg2-bin python3-matplotlib python3-h5py; do
    ! as_root dpkg -s $name >/dev/null 2>&1 || fail "$name is installed: the package must work without it"
  done
  as_root dpkg --verify clothbench | grep . && fail "installed files differ from the packed files"
  mkdir -p "$root$home"
  chown 65534:65534 "$root$home"
  local version
  version=$(as_user clothbench --version) || fail "the program does not start: is a dependency not declared?"
  ok "$version installed with its dependencies"
}

# Without its data the program must name every folder that it searched. The source tree's folder must not exist.
refuses_without_data() {
  local share=/usr/share/clothbench status=0 text source
  mv "$root$share" "$root$share.away"
  text=$(as_user clothbench list scenarios 2>&1) || status=$?
  mv "$root$share.away" "$root$share"
  [ $status = 2 ] || fail "without $share: expected exit code 2, not $status: $text"
  source=${text##*then }
  source=${source%%;*}
  case $text in *"$share/scenarios, then /"*CLOTHBENCH_SCENARIOS*) ;; *) fail "the message does not name every searched folder: $text" ;; esac
  [ ! -e "$root$source" ] || fail "$source exists: expected no source tree"
  ok "no source tree at $source"
}

# Other CI programs may run at the same time; the study's times are not used as measurements.
study_and_report() {
  quietly as_user CLOTHBENCH_JOBS=1 clothbench study table3 --quick --out study
  quietly as_user clothbench report study -o report
  local report=$root$home/report runs
  runs=$(find "$root$home/study" -name '*.h5' | wc -l)
  [ "$runs" -gt 10 ] || fail "the study has $runs runs"
  [ "$(($(wc -l <"$report/runs.csv") - 1))" = "$runs" ] || fail "report/runs.csv: expected the study's $runs runs"
  for solver in ballistic bullet-soft paper xpbd; do
    grep -qE "^\| gravity-8-single \| $solver \| single \|.* [0-9.]+ \|" "$report/report.md" || fail "report/report.md: no values of $solver"
  done
  [ -s "$report/index.html" ] || fail "no report/index.html"
  [ "$(grep -c 'Figures were left out: ' "$report/report.md")" = 1 ] || fail "report/report.md: expected one sentence on what is missing"
  ! ls "$report"/figures/*.svg >/dev/null 2>&1 || fail "report/figures: expected no figures, because no program to draw them is installed"
  ok "study of $runs runs, complete tables; $(grep -o 'Figures were left out: .*' "$report/report.md")"
}

example_plugin() {
  get cmake make gcc libc6-dev
  as_user cp -r /usr/share/doc/clothbench/examples/plugin mine
  quietly as_user cmake -S mine -B mine/build
  quietly as_user cmake --build mine/build
  quietly as_user clothbench run paper/gravity --solver plugin:mine/build/example_plugin.so --set 'cloth.grid=[8,8]' --trials 1 --out mine/run
  as_user clothbench report mine/run -o mine/report 2>/dev/null | grep example-xpbd >/dev/null || fail "the example plugin has no row"
  ok "the example plugin builds against the package and runs"
}

is_tidy() {
  ! as_root readelf -S /usr/bin/clothbench | grep -q '\.symtab' || fail "the program is not stripped"
  for file in doc/clothbench/copyright doc/clothbench/changelog.gz; do
    [ -s "$root/usr/share/$file" ] || fail "no /usr/share/$file"
  done
  as_root dpkg --verify clothbench | grep . && fail "running it changed its files"
  return 0
}

goes_without_trace() {
  quietly as_root apt-get purge -y clothbench
  local left
  left=$(find "$root/usr" -name '*clothbench*')
  [ -z "$left" ] || fail "left behind: $left"
  ok "removed without a trace"
}

install_it
refuses_without_data
study_and_report
example_plugin
is_tidy
goes_without_trace
