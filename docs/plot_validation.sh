#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws the pictures of docs/measured/validation.md from the tables in docs/measured/validation. Needs gnuplot.
set -eu
cd "$(dirname "$0")/measured/validation"
gnuplot <<'PLOT'
set terminal pngcairo size 900,600 font "sans,13" linewidth 1.5
set grid
set key right top

set output "../../images/validation_energy.png"
set logscale xy
set format y "10^{%T}"
set xrange [0.0008:0.01]
set yrange [5e-7:3e-3]
set xtics (0.001, 0.002, 0.004, 0.008)
set xlabel "time step, tau"
set ylabel "rms fluctuation of the total energy per atom, epsilon"
of(name) = sprintf("< grep '^%s ' nve.dat", name)
plot 1.14*x**2 dashtype 2 linecolor "gray40" title "dt^2", \
     of("LAMMPS_own") using 2:3 with points pointtype 6 pointsize 2.2 linecolor "black" title "LAMMPS, doubles, its own start", \
     of("LAMMPS") using 2:3 with points pointtype 4 pointsize 2.2 linecolor "black" title "LAMMPS, doubles, this start", \
     of("reference") using 2:3 with points pointtype 2 pointsize 1.5 linecolor "#d55e00" title "reference, doubles", \
     of("wide") using 2:3 with linespoints pointtype 7 linecolor "#0072b2" title "golden's bits, wide formats", \
     of("D_20") using 2:3 with linespoints pointtype 9 linecolor "#009e73" title "default formats, D = 20", \
     of("default") using 2:3 with linespoints pointtype 5 linecolor "#cc79a7" title "default formats"

reset
set terminal pngcairo size 900,600 font "sans,13" linewidth 1.5
set grid
set key right bottom
set output "../../images/validation_wave.png"
set logscale x
set xrange [8:125]
set xtics (10, 15, 25, 50, 100)
set yrange [0.994:1.006]
set xlabel "wavelength, cubic cells"
set ylabel "speed along [100] over sqrt(C11/density)"
half(n) = pi/(2*n)
plot sin(half(x))/half(x) linecolor "black" title "chain of planes", \
     "wave.dat" using 1:5 with points pointtype 2 pointsize 2 linecolor "#d55e00" title "reference, strain 1e-4", \
     "" using 1:4 with points pointtype 6 pointsize 1.5 linecolor "#0072b2" title "wide formats, strain 1e-4", \
     "" using 1:3 with points pointtype 7 pointsize 1.3 linecolor "#009e73" title "wide formats, strain 1e-3", \
     "" using 1:2 with points pointtype 5 pointsize 1.3 linecolor "#cc79a7" title "default formats, strain 1e-3"

reset
set terminal pngcairo size 900,600 font "sans,13" linewidth 1.5
set grid
set key right bottom
set output "../../images/validation_beam.png"
set logscale x
set xrange [3:42]
set xtics (3, 5, 10, 20, 40)
set yrange [0.75:1.02]
set xlabel "length over height"
set ylabel "first bending frequency over that of Euler and Bernoulli"
plot 1 linecolor "gray40" title "Euler and Bernoulli", \
     0.97 dashtype 3 linecolor "gray40" title "3 % below", \
     "beam_theory.dat" using 1:2 with lines linecolor "black" title "Timoshenko", \
     "beam.dat" using 2:6 with points pointtype 6 pointsize 2 linecolor "#0072b2" title "wide formats", \
     "" using 2:4 with points pointtype 5 pointsize 1.2 linecolor "#cc79a7" title "default formats"

reset
set terminal pngcairo size 900,600 font "sans,13" linewidth 1.5
set grid ytics
set output "../../images/validation_forces.png"
set datafile separator ";"
set logscale y
set format y "10^{%T}"
set yrange [1e-7:1e-2]
set xrange [-0.6:2.6]
set xtics ("liquid" 0, "crystal" 1, "block" 2)
set ylabel "median of 2 |a - b| / (|a| + |b|)"
set style fill solid 0.85
set boxwidth 0.24
set key right top
row(name) = sprintf("< grep -E ';%s;' forces.dat", name)
plot row("default") using ($0 - 0.26):3 with boxes linecolor "#cc79a7" title "default formats", \
     row("wide") using 0:3 with boxes linecolor "#0072b2" title "wide formats", \
     row("float32") using ($0 + 0.26):3 with boxes linecolor "#d55e00" title "float32", \
     2.6e-6 dashtype 2 linecolor "black" title "OpenMM, single (DHFR in water)", \
     8.8e-8 dashtype 3 linecolor "black" notitle
PLOT
