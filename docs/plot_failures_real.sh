#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws docs/images/failures_real.png from what the tests measure. Needs build/unit_tests and gnuplot.
set -eu
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
CUBOCT_VERBOSE=1 build/unit_tests '--gtest_filter=RealFailures.*' > "$work/all"
# Blocks as gnuplot's index takes them. The origin itself is drawn at 10 pitches: the axis is logarithmic.
for precision in float double; do
  awk -v p=$precision '$1 == p {print ($2 == 0 ? 10 : $2), $4, ($6 < 0 ? -$6 : $6), ($7 < 0 ? -$7 : $7)}' "$work/all" > "$work/far_$precision"
  for scene in order_of_sums order_of_sums_healthy; do
    awk -v p=$precision -v s=$scene '$1 == s && $2 == p && $4 > 0 {print $3, $4}' "$work/all" > "$work/${scene}_$precision"
  done
done
gnuplot <<PLOT
set terminal pngcairo size 1200,430 font "Helvetica,11" background "white"
set output "${1:-docs/images/failures_real.png}"
set multiplot layout 1,3
set grid lc rgb "#dddddd"
set border 3
set tics nomirror
set logscale xy
set format y "10^{%T}"
set format x "10^{%T}"
set xrange [5:2e6]
set xtics ("origin" 10, "10^2" 1e2, "10^3" 1e3, "10^4" 1e4, "10^5" 1e5, "10^6" 1e6)
set xlabel "distance from the origin / pitch"
set title "median force error"
set key left top
plot "$work/far_float" u 1:2 w lp lw 2 pt 7 lc rgb "#d62728" title "floats", \
     "$work/far_double" u 1:2 w lp lw 2 pt 7 lc rgb "#1f77b4" title "doubles"
set title "energy gained in 1000 steps / kinetic energy"
plot "$work/far_float" u 1:4 w lp lw 2 pt 7 lc rgb "#d62728" title "floats", \
     "$work/far_double" u 1:4 w lp lw 2 pt 7 lc rgb "#1f77b4" title "doubles"
unset logscale x
set xrange [0:5000]
set xtics 1000
set format x "%g"
set xlabel "step"
set title "distance of two orders of summation / pitch"
set key right bottom
plot "$work/order_of_sums_float" w lp lw 2 pt 7 lc rgb "#d62728" title "floats, hot", \
     "$work/order_of_sums_double" w lp lw 2 pt 7 lc rgb "#1f77b4" title "doubles, hot", \
     "$work/order_of_sums_healthy_float" w lp lw 2 pt 6 dt 2 lc rgb "#d62728" title "floats, cold", \
     "$work/order_of_sums_healthy_double" w lp lw 2 pt 6 dt 2 lc rgb "#1f77b4" title "doubles, cold"
PLOT
