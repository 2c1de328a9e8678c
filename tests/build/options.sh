#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Configures the tree with each part switched off, and with what each part needs missing: a part that is left out is
# told, and its targets are gone; the others stay.
# usage: options.sh ROOT [all]; all: with what users have set themselves, too
set -euo pipefail
root=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CUDACXX=/nowhere/nvcc  # looking for a GPU's compiler takes longest
unset CMAKE_C_COMPILER_LAUNCHER CMAKE_CXX_COMPILER_LAUNCHER CMAKE_CUDA_COMPILER_LAUNCHER

configure() {  # SOURCES OPTION...
  local from=$1
  shift
  rm -rf "$work/build"
  cmake -S "$from" -B "$work/build" -G Ninja "$@" >"$work/said" 2>&1 || { cat "$work/said"; exit 1; }
  ninja -C "$work/build" -t targets all | sed 's/: .*//' >"$work/targets"
}
says() { grep -qxF -- "-- $1" "$work/said" || { echo "configuring does not say: $1"; cat "$work/said"; exit 1; }; }
has() {
  local target
  for target; do grep -qx "$target" "$work/targets" || { echo "no target $target"; exit 1; }; done
}
lacks() {
  local target
  for target; do if grep -qx "$target" "$work/targets"; then echo "there is a target $target"; exit 1; fi; done
}
parts=(_cuboct cuboct_library cuboct_fit cuboct_ranks cuboct_study cuboct_synth cuboct-view cuboct-systemc cuboct-rtl unit_tests)

configure "$root" -DCUBOCT_{CCACHE,MOLD,CUDA,FITS,LIBRARY,MPI,PYTHON,STUDIES,SYNTH,SYSTEMC,TESTS,VIEW}=OFF
says "The gpu engine: without its program cuboct-gpu, as this build has sanitizers or CUBOCT_CUDA is OFF"
says "The lattice engine: on one rank alone, as CUBOCT_MPI is OFF"
says "Python: left out, as CUBOCT_PYTHON is OFF"
says "The C++ library: left out, as this build has sanitizers or CUBOCT_LIBRARY is OFF"
says "Studies: left out, as CUBOCT_STUDIES is OFF"
says "Fits: left out, as CUBOCT_FITS is OFF"
says "Synthesis: left out, as CUBOCT_SYNTH is OFF"
says "View: left out, as CUBOCT_VIEW is OFF"
says "The systemc and rtl engines: without their programs, as CUBOCT_SYSTEMC is OFF"
says "Tests: left out, as CUBOCT_TESTS is OFF"
has cuboct cuboct-{bench,lattice,machine,study}
lacks "${parts[@]}" cuboct-gpu
says "ccache: not used, as CUBOCT_CCACHE is OFF"
says "mold: not used, as CUBOCT_MOLD is OFF"
if grep -q 'ccache\|mold' "$work"/build/{build.ninja,CMakeFiles/rules.ninja}; then echo "ccache or mold is used"; exit 1; fi

# Nothing found. The tree stands there by links, so that study/report/web can be without node_modules.
mkdir -p "$work/bare/study/report/web" "$work/pkgconfig"
ln -s "$root"/[!.]* "$work/bare" 2>/dev/null || true
ln -s "$root"/study/* "$work/bare/study" 2>/dev/null || true
ln -s "$root"/study/report/web/*.* "$work/bare/study/report/web"
for folder in $(tr : ' ' <<<"$(pkg-config --variable pc_path pkg-config)"); do
  [ ! -e "$folder/libhwy.pc" ] || cp "$folder/libhwy.pc" "$work/pkgconfig"
done
PKG_CONFIG_LIBDIR=$work/pkgconfig configure "$work/bare" -DCMAKE_DISABLE_FIND_PACKAGE_{SQLite3,MPI,GTest,pybind11}=ON -DCUBOCT_MKDOCS=
says "The gpu engine: without its program cuboct-gpu, as no CUDA compiler (nvcc) works here"
says "The lattice engine: on one rank alone, as MPI (libopenmpi-dev) is not found"
says "Python: left out, as Python 3.11 (python3-dev) or pybind11 (pybind11-dev) is not found"
says "Studies: left out, as SQLite (libsqlite3-dev) is not found"
says "Fits: left out, as studies are"
says "View: left out, as libmicrohttpd (libmicrohttpd-dev) is not found"
says "The systemc and rtl engines: without their programs, as SystemC (libsystemc-dev) is not found"
says "Tests: left out, as GoogleTest (libgtest-dev) is not found"
says "The pages as HTML: without the target docs, as mkdocs (Debian package mkdocs) is not found"
has cuboct cuboct-lattice cuboct_synth
if command -v ccache >/dev/null; then
  says "ccache: $(command -v ccache)"
  grep -q 'CCACHE_SLOPPINESS=pch_defines,time_macros' "$work/build/CMakeFiles/rules.ninja"
else
  says "ccache: not used, as it is not found"
fi
lacks _cuboct cuboct_fit cuboct_ranks cuboct_study cuboct-systemc cuboct-rtl unit_tests docs

[ "${2-}" = all ] || { echo "two ways to configure"; exit; }
configure "$work/bare" -DCUBOCT_SYSTEMC=OFF -DCMAKE_DISABLE_FIND_PACKAGE_pagmo=ON -DCMAKE_CXX_COMPILER_LAUNCHER=env -DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=bfd -DCUBOCT_MKDOCS=/bin/true
says "Compiler launcher, as given: env"
says "Linker, as given: -fuse-ld=bfd"
says "Studies: without their page, as study/report/web/node_modules is missing: run tools/setup, or npm ci --ignore-scripts in study/report/web"
says "Fits: left out, as pagmo (libpagmo-dev) is not found"
has cuboct cuboct_study unit_tests study_tests docs
lacks cuboct_fit fit_tests web_tests systemc_tests program_tests link_rtl_tests
echo "three ways to configure"
