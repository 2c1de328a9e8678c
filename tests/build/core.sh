#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# `cuboct` stays small: it loads and links only what a run needs. Other libraries belong to the programs beside it.
# usage: core.sh BUILD_DIRECTORY NINJA
set -euo pipefail
build=$1 ninja=$2
libraries='lib(c|fmt|gcc_s|hdf5(_serial)?|hwy|m|stdc\+\+|sz|tomlplusplus|z)|ld-linux-[a-z0-9-]+'
parts='cuboct_cli|cuboct_hw_core|cuboct_hw_pipeline|cuboct_lattice|cuboct_lattice_run|cuboct_model_core|cuboct_model_files|cuboct_program|cuboct_timing'
own='cuboct|cuboct-read-trace|library_headers'

loads() { readelf -d "$build/$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'; }
links() { "$ninja" -C "$build" -t inputs "$1" | sed -n 's|.*/CMakeFiles/\([^/]*\)\.dir/.*\.o$|\1|p' | sort -u; }
beyond() { { loads "$1" | grep -vE "^($libraries)\.so" || true; links "$1" | grep -vE "^($parts|$own)$" || true; } | tr '\n' ' '; }

# The check itself: other programs do have more.
for known in cuboct-bench:libbenchmark cuboct-machine:cuboct_hw_machine; do
  case "$(beyond "${known%:*}")" in *"${known#*:}"*) ;; *) echo "${known#*:} is not seen in ${known%:*}"; exit 1 ;; esac
done
more=$(beyond cuboct)
[ -z "$more" ] || { echo "cuboct has more than a run needs: $more"; exit 1; }
echo "cuboct loads $(loads cuboct | wc -l) libraries and links $(links cuboct | wc -l) targets"
