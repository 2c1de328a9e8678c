#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# An installed cuboct loads nothing but what lies beside it and glibc, is small, and runs.
# usage: install.sh BUILD_DIRECTORY
set -euo pipefail
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
cmake --install "$1" --strip --prefix "$prefix" >/dev/null

glibc='linux-vdso|ld-linux-x86-64|libc|libm|libmvec|libdl|librt|libpthread|libresolv|libutil|libanl'
checked=0
for program in "$prefix"/bin/*; do
  list=$(env -u LD_LIBRARY_PATH ldd "$program")
  while read -r name _ path _; do
    checked=$((checked + 1))
    [[ $(basename "$name") =~ ^($glibc)\.so ]] && continue
    if [[ $path != "$prefix"/* ]]; then echo "$(basename "$program") loads $name from ${path:-nowhere}"; exit 1; fi
  done <<<"$list"
done
[ "$checked" -gt 10 ] || { echo "only $checked libraries seen"; exit 1; }

size=$(du -sb --apparent-size "$prefix/bin" "$prefix/lib" | awk '{ sum += $1 } END { print sum }')
[ "$size" -lt 56000000 ] || { echo "programs and libraries take $size bytes"; exit 1; }

cd "$prefix"
env -i "$prefix/bin/cuboct" run scenes/lj_block.toml --steps 2 | grep -q '^engine *lattice$'
if [ -e bin/cuboct-gpu ] && [ ! -e /dev/nvidiactl ]; then
  if env -i "$prefix/bin/cuboct" run scenes/lj_block.toml --engine gpu --steps 2 >out 2>err; then exit 1; else code=$?; fi
  [ "$code" = 2 ]
  [ "$(cat err)" = 'the gpu engine needs a CUDA device: no driver (libcuda.so.1)' ] || { cat err; exit 1; }
fi
echo "$(ls bin | wc -l) programs, $(ls lib | wc -l) files of libraries, $size bytes"
