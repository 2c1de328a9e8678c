#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What is installed has the same bytes when the same sources are built in another folder, of another length, without ccache. The
# first build is the one at hand; the second is made of a copy of the sources.
# usage: reproducible.sh ROOT BUILD_DIRECTORY [all]; all: every program and library but cuboct-gpu, by default the core and its rules
set -euo pipefail
root=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
copy=$work/another/folder/with/a/longer/name/for/the/same/sources
targets=(cuboct cuboct-read-trace kept_rules)
# nvcc names what is local to a file by the path of that file, so that cuboct-gpu depends on its folder.
[ "${3-}" != all ] || targets+=(cuboct-{bench,board-sim,fpga,lattice,machine,read-mesh,rtl,study,systemc,view} cuboct_{library,mesh,evolution,machine_evolution} _cuboct)

# Files of the checkout as they are now, and its commit, of which the programs tell.
mkdir -p "$copy"
git -C "$root" ls-files -z | (cd "$root" && tar --null --files-from=- --create) | tar --extract --directory "$copy"
git clone --quiet --shared --no-checkout "$root" "$work/clone"
mv "$work/clone/.git" "$copy"
git -C "$copy" reset --quiet
for web in study/report/web cli/view/web; do
  [ ! -d "$root/$web/node_modules" ] || cp -r "$root/$web/node_modules" "$copy/$web"
done

mapfile -t options < <(sed -nE 's/^((CUBOCT_[A-Z0-9]+|CMAKE_BUILD_TYPE|CMAKE_CXX_COMPILER|CMAKE_CXX_FLAGS[A-Z_]*):[A-Z]+=.*)/-D\1/p' "$build/CMakeCache.txt" | grep -v 'CCACHE\|TESTS')
cmake -S "$copy" -B "$copy/build" -G Ninja "${options[@]}" -DCUBOCT_CCACHE=OFF -DCUBOCT_TESTS=OFF >"$work/log" 2>&1 || { tail -n 50 "$work/log"; exit 1; }
known() { ninja -C "$copy/build" -t query "$1" >/dev/null 2>&1; }
made=()
for target in "${targets[@]}"; do
  if known "$target"; then made+=("$target"); fi
done
ninja -C "$copy/build" "${made[@]}" >"$work/log" 2>&1 || { tail -n 50 "$work/log"; exit 1; }

files=0 bytes=0
while read -r file; do
  cmp "$build/$file" "$copy/build/$file"
  files=$((files + 1)) bytes=$((bytes + $(stat -c %s "$build/$file")))
done < <(cd "$copy/build" && find . -maxdepth 1 -name 'cuboct*' -type f -executable && find rules library python/cuboct -name '*.so*' -type f 2>/dev/null)
[ "$files" -ge 2 ]
echo "$files files, $bytes bytes, the same in two folders"
