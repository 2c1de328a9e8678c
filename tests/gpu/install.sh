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
modules=()
[ ! -e "$prefix/lib/cuboct-mesh.so" ] || modules=("$prefix/lib/cuboct-mesh.so")
for program in "$prefix"/bin/* "${modules[@]}"; do
  list=$(env -u LD_LIBRARY_PATH ldd "$program")
  while read -r name _ path _; do
    checked=$((checked + 1))
    [[ $(basename "$name") =~ ^($glibc)\.so ]] && continue
    if [[ $path != "$prefix"/* ]]; then echo "$(basename "$program") loads $name from ${path:-nowhere}"; exit 1; fi
  done <<<"$list"
done
[ "$checked" -gt 10 ] || { echo "only $checked libraries seen"; exit 1; }

size=$(du -sb --apparent-size "$prefix/bin" "$prefix/lib" | awk '{ sum += $1 } END { print sum }')
most=82000000
[ ${#modules[@]} = 0 ] || most=140000000  # with Embree and Assimp
[ ! -e "$prefix/bin/cuboct-view" ] || most=$((most + 14000000))  # and what libmicrohttpd loads: GnuTLS
[ ! -e "$prefix/lib/libcuboct.so" ] || most=$((most + 26000000))  # and what HDF5's shared library loads
[ "$size" -lt "$most" ] || { echo "programs and libraries take $size bytes"; exit 1; }

cd "$prefix"
env -i "$prefix/bin/cuboct" run scenes/lj_block.toml --steps 2 | grep -q '^engine *lattice$'
# So did the programs of other commands.
for command in elastic energy bench; do env -i "$prefix/bin/cuboct" "$command" --help | grep -q "^usage: cuboct $command "; done
# What reads strangers' files came along, and is found.
env -i "$prefix/bin/cuboct" run scenes/lj_block.toml --steps 2 --quiet --out first >/dev/null
env -i "$prefix/bin/cuboct" run scenes/lj_block.toml --steps 2 --quiet --from first | grep -q '^engine *lattice$'
if [ ${#modules[@]} != 0 ]; then
  printf 'v %s\n' '0 0 0' '9 0 0' '0 9 0' '0 0 9' >body.obj
  printf 'f %s\n' '1 3 2' '1 2 4' '1 4 3' '2 3 4' >>body.obj
  cat >body.toml <<'TOML'
density = "1 g/cm^3"
packing = { pitch = "1 mm" }
geometry = { shape = "mesh", file = "body.obj", unit = "mm" }
law = { kind = "elastic", stiffness = "1 kN/m" }
run = { dt = "auto", steps = 1 }
TOML
  env -i "$prefix/bin/cuboct" check body.toml | grep -q 'volume 1.215e-07 m^3'
fi
if [ -e bin/cuboct-gpu ] && [ ! -e /dev/nvidiactl ]; then
  if env -i "$prefix/bin/cuboct" run scenes/lj_block.toml --engine gpu --steps 2 >out 2>err; then exit 1; else code=$?; fi
  [ "$code" = 2 ]
  [ "$(cat err)" = 'the gpu engine needs a CUDA device: no driver (libcuda.so.1)' ] || { cat err; exit 1; }
fi
echo "$(ls bin | wc -l) programs, $(ls lib | wc -l) files of libraries, $size bytes"
