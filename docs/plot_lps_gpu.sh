#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# docs/images/glass_1m.png: the damaged points that `cuboct-gpu lps tests/gpu/lps/glass_1m.toml --points POINTS` leaves.
# usage: plot_lps_gpu.sh POINTS
set -euo pipefail
gnuplot <<END
set terminal pngcairo size 900,420 font "sans,10"
set output "$(dirname "$0")/images/glass_1m.png"
set multiplot layout 1,2
set xrange [45:100]; set yrange [-20:20]; set size ratio -1
set xlabel "x, mm"; set ylabel "y, mm"; unset key; set cblabel "damage"; set cbrange [0:0.6]
set palette defined (0 "#dddddd", 0.3 "#4477aa", 0.6 "#000000"); unset colorbox
do for [kind in "float double"] {
  set title kind."s"
  plot "$1.".kind.".tsv" skip 1 using (1e3*\$1):(1e3*\$2):4 with points pt 7 ps 0.15 palette
}
END
