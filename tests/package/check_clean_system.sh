#!/usr/bin/env bash
# Do the Debian packages install and work on a system that has nothing but Debian's base?
#
#   tests/package/check_clean_system.sh BUILD [--library]
#
# Makes the packages of a build folder (of the preset `release`), puts a minimal Debian 12 into a
# temporary folder, installs the packages there with apt, and works as an ordinary user of it: smooth,
# verify, a batch, the manual page, completion, and what is told where there is no FreeCAD. With
# --library the example of the library is built there, too (some hundred MB of compiler).
#
# Needs root, debootstrap and a Debian mirror: the environment variable BATTEN_MIRROR, or debootstrap's
# own. Some minutes; so it is no part of ctest.
set -euo pipefail

fail() {
  echo "check_clean_system: $*" >&2
  exit 1
}

[[ $# -ge 1 && -f $1/CPackConfig.cmake ]] || {
  sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
  exit 1
}
build=$(cd "$1" && pwd)
library=${2:-}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
[[ $EUID -eq 0 ]] || fail "needs root"
command -v debootstrap >/dev/null || fail "needs debootstrap"

scratch=$(mktemp -d)
trap 'rm -rf --one-file-system "$scratch"' EXIT
clean=$scratch/debian

inside() { chroot "$clean" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
as_user() {
  chroot --userspec=machinist:machinist "$clean" env -i PATH=/usr/bin:/bin LC_ALL=C.UTF-8 \
    HOME=/home/machinist MANPAGER=cat sh -c "cd /home/machinist && $1"
}
# Shows the command, and stops when its exit code is not the one that is named first.
expect() {
  local code=$1 found=0
  echo "\$ $2"
  as_user "$2" >"$scratch/said" 2>&1 || found=$?
  sed 's/^/    /' "$scratch/said" | head -n 12
  [[ $found -eq $code ]] || fail "exit code $found, expected $code"
}
expect_said() { grep -q -- "$1" "$scratch/said" || fail "'$1' is not in what was said"; }

echo "packages of $build"
cpack -G DEB --config "$build/CPackConfig.cmake" -B "$scratch/packages" >"$scratch/log" 2>&1 || {
  cat "$scratch/log" >&2
  fail "cpack"
}
echo "a minimal Debian 12"
debootstrap --variant=minbase bookworm "$clean" ${BATTEN_MIRROR:+"$BATTEN_MIRROR"} >"$scratch/log" 2>&1 || {
  tail -n 20 "$scratch/log" >&2
  fail "debootstrap"
}
mkdir "$clean/packages"
cp "$scratch"/packages/*.deb "$clean/packages/"
inside useradd --create-home machinist

echo "apt-get install batten"
inside apt-get update >"$scratch/log" 2>&1 || fail "$(tail -n 5 "$scratch/log")"
install() {
  inside apt-get install --yes --no-install-recommends "$@" >"$scratch/log" 2>&1 || {
    tail -n 20 "$scratch/log" >&2
    fail "apt-get install $*"
  }
  grep -h 'newly installed' "$scratch/log" || true
}
inside sh -c 'apt-get install --yes --no-install-recommends /packages/batten_*.deb' >"$scratch/log" 2>&1 || {
  tail -n 20 "$scratch/log" >&2
  fail "apt-get install"
}
grep -h 'newly installed' "$scratch/log"
install man-db

cp "$root/samples/butterfly/program.ngc" "$clean/home/machinist/part.ngc"
expect 0 'batten --version'
expect 0 'batten smooth part.ngc --target linuxcnc --tolerance 0.015 --report part.html'
expect_said 'proof'
expect 0 'batten verify part.ngc part.smooth.ngc --tolerance 0.015'
expect_said 'proved'
expect 0 'mkdir programs && cp part.ngc programs && batten batch programs smooth --target linuxcnc --tolerance 0.015'
expect 0 'cmp smooth/part.ngc part.smooth.ngc'
expect 0 'man batten'
expect_said 'BATTEN(1)'
expect 0 'ls /usr/share/bash-completion/completions/batten /usr/share/zsh/vendor-completions/_batten'
expect 4 'batten freecad install'
expect_said 'no FreeCAD was found in PATH'
expect 0 'find . -type f | sort'
! grep -q batten_post "$scratch/said" || fail "a post where there is no FreeCAD"

if [[ $library == --library ]]; then
  echo "apt-get install libbatten-dev, and a compiler"
  inside sh -c 'apt-get install --yes --no-install-recommends /packages/libbatten-dev_*.deb g++ make cmake' >"$scratch/log" 2>&1 || {
    tail -n 20 "$scratch/log" >&2
    fail "apt-get install libbatten-dev"
  }
  grep -h 'newly installed' "$scratch/log"
  cp -r "$root/api/example" "$clean/home/machinist/example"
  chown -R 1000:1000 "$clean/home/machinist/example"
  expect 0 'cmake -S example -B build && cmake --build build'
  expect 0 'build/smooth_file part.ngc 0.015 > library.ngc'
  expect 0 'cmp library.ngc part.smooth.ngc'
fi
echo "everything works on a clean system"
