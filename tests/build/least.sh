#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds cuboct with every part left out; what is asked of such a part is refused with the option that brings it. It is compiled by
# the other of g++ and clang++, where both are there: both programs make the same plans, states and frames.
# usage: least.sh ROOT BUILD_DIRECTORY WHOLE_BUILD
set -euo pipefail
root=$1 build=$2 whole=$3
compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "$whole/CMakeCache.txt")
[ -n "$compiler" ] || { echo "$whole names no compiler"; exit 1; }
case $("$compiler" --version) in *clang*) other=g++ ;; *) other=clang++ ;; esac
command -v "$other" >/dev/null || other=$compiler
[ ! -e "$build/CMakeCache.txt" ] || grep -q "^CMAKE_CXX_COMPILER:.*$other\$" "$build/CMakeCache.txt" || rm -rf "$build"  # made by another
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$other" -DCUBOCT_{CUDA,FITS,LIBRARY,MPI,PYTHON,STUDIES,SYNTH,SYSTEMC,TESTS,VIEW}=OFF >/dev/null
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

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Of a run: the hashes of its plan and state, and the sums of its frames.
left_by() {  # BUILD SCENE ENGINE
  local stage
  stage=$(sed -n '/^\[\[stage\]\]/,/name/s/^name *= *"\(.*\)".*/--stage=\1/p' "$2" | head -1)
  "$1/cuboct" run "$2" --steps 3 ${stage:+"$stage"} --engine "$3" --no-watch --force --out "$work/out" >"$work/said" 2>&1 || { cat "$work/said"; exit 1; }
  sed -n 's/^\(plan\|state\) hash *//p' "$work/said"
  (cd "$work/out" && md5sum plan.txt frames_*.vt? 2>/dev/null)
}
compared=0
for scene in "$root"/scenes/*.toml "$root"/scenes/rules/*.toml; do
  for engine in lattice reference; do
    case $(basename "$scene") in graphene.toml) [ "$engine" = reference ] || continue ;; esac
    left_by "$whole" "$scene" "$engine" >"$work/whole"
    left_by "$build" "$scene" "$engine" >"$work/least"
    [ -s "$work/whole" ] || { echo "$scene: no hash and no frame"; exit 1; }
    diff "$work/whole" "$work/least" || { echo "$scene in $engine: other bits by $other than by $compiler"; exit 1; }
    compared=$((compared + 1))
  done
done
echo "ten refusals; $compared runs with the same bits by $other and $compiler"
