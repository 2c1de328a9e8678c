#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws docs/images/coarse.png: points of a torn sheet of atoms, by two kinds of weights. Needs g++ and gnuplot.
#   docs/plot_coarse.sh BUILD_DIRECTORY
set -eu
build=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
g++ -std=c++20 -O1 -I. $(pkg-config --cflags eigen3 fmt) docs/coarse_data.cpp "$build/model/libcuboct_model.a" \
  $(pkg-config --libs fmt libhwy) -lpthread -o "$work/coarse_data"
"$work/coarse_data" > "$work/points.txt"
gnuplot <<PLOT
set terminal png size 960,520 font "Helvetica,13" background "white"
set output "docs/images/coarse.png"
set multiplot layout 1,2
set size ratio -1
set xrange [-32:32]
set yrange [-54:10]
set xlabel "angstrom"
unset key
set title "weights of cones"
plot "$work/points.txt" index 0 with points pt 7 ps 0.35 lc rgb "#8fb4dc", "" index 1 with points pt 7 ps 0.9 lc rgb "#c0302a"
set title "weights that avoid jumps"
plot "$work/points.txt" index 0 with points pt 7 ps 0.35 lc rgb "#8fb4dc", "" index 2 with points pt 7 ps 0.9 lc rgb "#c0302a"
PLOT
