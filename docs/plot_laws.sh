#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws docs/images/laws.svg from the code of the laws. Needs g++, fmt, Eigen and gnuplot.
set -eu
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
g++ -std=c++20 -O1 -I. $(pkg-config --cflags eigen3 fmt) docs/laws_data.cpp model/contract/law.cpp model/base/error.cpp \
  $(pkg-config --libs fmt) -o "$work/laws_data"
"$work/laws_data" > "$work/laws.txt"
gnuplot <<PLOT
set terminal ${1:-svg} size 900,380 font "Helvetica,13" background "white"
set output "${2:-docs/images/laws.svg}"
set multiplot layout 1,2
set grid lc rgb "#dddddd"
set border 3
set tics nomirror
set xlabel "distance r / pitch"
set ylabel "force / (stiffness · pitch)"
set xzeroaxis lc rgb "#888888"
do for [panel = 0:1] {
  if (panel == 0) { set xrange [0:1.45]; set yrange [-0.16:0.4]; set xtics 0.2; set key top right opaque
                    set title "the whole law: core, pitch, cutoff" }
  else { set xrange [0.97:1.43]; set yrange [-0.145:0.03]; set xtics 0.1; set key off
         set title "above the pitch" }
  set arrow 1 from sqrt(2), graph 0 to sqrt(2), graph 1 nohead dt 2 lc rgb "#888888"
  set arrow 2 from 1, graph 0 to 1, graph 1 nohead dt 2 lc rgb "#888888"
  plot "$work/laws.txt" index 0 with lines lw 2 lc rgb "#1f77b4" title "elastic", \
       "" index 1 with lines lw 2 lc rgb "#d62728" title "brittle", \
       "" index 2 with lines lw 2 lc rgb "#2ca02c" title "ductile", \
       "" index 3 with lines lw 2 lc rgb "#9467bd" title "viscous"
}
PLOT
