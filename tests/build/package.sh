#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The Debian package: made twice it has the same bytes, lintian finds no error in it, it installs by apt into a Debian 12 that has nothing else, and works there. Needs
# root, debootstrap and Debian's mirror; skipped without the first two.
# usage: package.sh BUILD_DIRECTORY; MIRROR=URL for another than Debian's
set -euo pipefail
build=$1
command -v debootstrap >/dev/null && [ "$(id -u)" = 0 ] || { echo "skipped: no root, or no debootstrap (apt-get install debootstrap)"; exit 77; }
work=$(mktemp -d)
clean=$work/debian
tidy() {
  if mountpoint -q "$clean/proc"; then umount "$clean/proc"; fi
  rm -rf --one-file-system "$work"
}
trap tidy EXIT
(cd "$build" && cpack -G DEB -B "$work" >"$work/log" 2>&1) || { cat "$work/log"; exit 1; }
package=$(echo "$work"/cuboct_*.deb)
(cd "$build" && cpack -G DEB -B "$work/again" >"$work/log" 2>&1) || { cat "$work/log"; exit 1; }
cmp "$package" "$work/again/$(basename "$package")"  # though it was made later
if command -v lintian >/dev/null; then
  # 0: no tag of an error. 2: some. Another code: lintian itself failed.
  lintian --tag-display-limit 0 --fail-on error "$package" >"$work/lintian" 2>"$work/lintian.err" ||
    { echo "lintian: exit code $?"; grep '^E:' "$work/lintian" || cat "$work/lintian.err"; exit 1; }
fi

debootstrap --variant=minbase bookworm "$clean" "${MIRROR:-http://deb.debian.org/debian}" >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
mount -t proc proc "$clean/proc" || { echo "skipped: cannot mount /proc"; exit 77; }
cp "$package" "$clean/tmp"
within() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive chroot "$clean" "$@"; }
# What a minimal Debian leaves out of packages: their pages.
rm -f "$clean"/etc/dpkg/dpkg.cfg.d/*
within apt-get install -y --no-install-recommends "/tmp/$(basename "$package")" man-db >"$work/log" 2>&1 || { tail -n 40 "$work/log"; exit 1; }

within sh -euc '
  cd /root
  cuboct new arm --like beam >/dev/null
  cuboct check arm.toml | grep -q "^body "
  cuboct run arm.toml --steps 20 --out out --quiet | grep -q "^engine *lattice"
  cuboct run arm.toml --from out --steps 20 --quiet | grep -q "^engine *lattice"  # reads what the first run left
  cuboct crosscheck /usr/share/cuboct/scenes/lj_block.toml --engines golden,lattice,systemc --steps 3
  # A rule that ships runs compiled, though there is no compiler.
  cuboct run /usr/share/cuboct/scenes/rules/langevin.toml --engine lattice --rule-code compiled --steps 5 --quiet | grep -q "^engine *lattice"
  for command in elastic energy bench fit; do cuboct $command --help | grep -q "^usage: cuboct $command "; done
  python3 -c "
import cuboct
assert cuboct.__file__.startswith(\"/usr/lib/python3/dist-packages/\"), cuboct.__file__
assert cuboct.crosscheck(\"/usr/share/cuboct/scenes/lj_block.toml\", [\"golden\", \"systemc\"], steps=2)
print(\"python:\", cuboct.__version__)"
  for page in cuboct cuboct-run cuboct-explore; do man $page | head -n 1 | grep -qi "^$page(1)"; done
  man -w cuboct-bench >/dev/null
  test -s /usr/share/doc/cuboct/copyright
  cuboct --version | head -n 1
'
# A program of another: with a compiler, and nothing of ours beside it.
within apt-get install -y --no-install-recommends g++ cmake make >"$work/log" 2>&1 || { tail -n 40 "$work/log"; exit 1; }
mkdir "$clean/root/pull"
awk -v to="$clean/root/pull/" '/^```/ { inside = !inside; file = ""; next } inside && file == "" { file = to $2 } inside && /./ { print >file }' \
  <(sed -n '/^```c/,/^```$/p' "$(dirname "$0")/../../docs/user/cpp.md")
within sh -euc '
  cd /root/pull
  cmake -B build >/dev/null && cmake --build build >/dev/null
  build/pull /usr/share/cuboct/scenes/coupon.toml | grep "^hash "'
within apt-get purge -y cuboct >"$work/log" 2>&1
left=$(find "$clean/usr" -name '*cuboct*')
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
echo "$(stat -c %s "$package") bytes, $(grep -c '^W:' "$work/lintian" 2>/dev/null || true) warnings of lintian"
