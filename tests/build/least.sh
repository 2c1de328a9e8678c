#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds cuboct with every part left out; what is asked of such a part is refused with the option that brings it.
# usage: least.sh ROOT BUILD_DIRECTORY
set -euo pipefail
root=$1 build=$2
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCUBOCT_{CUDA,FITS,LIBRARY,MPI,PYTHON,STUDIES,SYNTH,SYSTEMC,TESTS,VIEW}=OFF >/dev/null
ninja -C "$build" cuboct cuboct-machine cuboct-lattice >"$build/log" 2>&1 || { tail -n 50 "$build/log"; exit 1; }

refuses() {  # TEXT ARGUMENT...
  local text=$1 code=0 said
  shift
  said=$("$build/cuboct" "$@" 2>&1) || code=$?
  [ "$code" = 2 ] && [ "$said" = "$text" ] || { printf 'cuboct %s: exit code %s\n%s\n' "$*" "$code" "$said"; exit 1; }
}
studies='this cuboct was built without studies
  hint: configure with -DCUBOCT_STUDIES=ON'
synthesis='this cuboct was built without synthesis
  hint: configure with -DCUBOCT_SYNTH=ON'
scene=$root/scenes/lj_block.toml
refuses "explore: $studies" explore study.toml --error 1%
refuses "explore: $studies" explore
refuses "stability: $studies" stability "$scene"
refuses 'fit: this cuboct was built without fits
  hint: configure with -DCUBOCT_FITS=ON' fit study.toml
refuses 'view: this cuboct was built without the page of a run
  hint: install libmicrohttpd (libmicrohttpd-dev) and configure with -DCUBOCT_VIEW=ON' view "$build"
refuses "synth: $synthesis" synth project --target up5k
refuses "emit --fit: $synthesis" emit "$scene" --fit ecp5-85 --out "$build/project"
[ ! -e "$build/project" ]
refuses '--ranks 2: the lattice engine was built without MPI
  hint: --threads uses the cores of this machine' run "$scene" --steps 1 --ranks 2
refuses 'the systemc engine is not built: no program cuboct-systemc beside cuboct
  hint: install libsystemc-dev and build again; a directory of '\''cmake --install'\'' has no such engine' run "$scene" --steps 1 --engine systemc
"$build/cuboct" crosscheck "$scene" --steps 2 --engines golden,lattice | grep -qx 'matched 512 updates over 2 steps in 2 engines'
echo "ten refusals, and a run"
