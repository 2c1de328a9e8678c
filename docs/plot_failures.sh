#!/bin/sh
# SPDX-License-Identifier: MIT
# Draws docs/images/failures.svg from runs of the scenes. Needs build/cuboct, python3-h5py and gnuplot.
set -eu
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# curve TRACE NAME: a curve of a trace, "step value" lines.
curve() {
  /usr/bin/python3 - "$@" <<'PYTHON'
import sys, h5py
with h5py.File(sys.argv[1]) as trace:
    curve = trace["curves/" + sys.argv[2]]
    for step, value in zip(curve["step"], curve["value"]):
        print(f"{step} {value:.9g}")
PYTHON
}
# run NAME CURVE SCENE [ARCH]: the curve to $work/NAME, times counted in steps of the run.
run() {
  build/cuboct run "scenes/failures/$3.toml" ${4:+--arch "scenes/failures/archs/$4.toml"} --no-watch \
    --out "$work/$1.run" >/dev/null || true  # a run that is sick may stop
  curve "$work/$1.run/trace.h5" "$2" >"$work/$1"
}
for name in time_step damping stiff_hold; do
  run $name energy.kinetic $name
  run ${name}_healthy energy.kinetic ${name}_healthy
done
for name in force_jump force_jump_healthy; do run $name energy.total $name; done
for name in constraint_work constraint_work_healthy; do run $name press.force_z $name; done
run heating energy.total heating heating
run heating_healthy energy.total heating heating_healthy
first() { head -1 "$work/$1" | cut -d' ' -f2; }
gnuplot <<PLOT
set terminal ${1:-svg} size 1100,640 font "Helvetica,12" background "white"
set output "${2:-docs/images/failures.svg}"
set multiplot layout 2,3
set grid lc rgb "#dddddd"
set border 3
set tics nomirror
set xlabel "step of the failing run"
set key top center
sick = "#d62728"; healthy = "#1f77b4"
set logscale y
set format y "10^{%T}"
set ylabel "kinetic energy / J"
set title "time step: 0.85 and 0.2 of the limit"
plot "$work/time_step" w l lw 2 lc rgb sick title "fails", \
     "$work/time_step_healthy" u (\$1*0.2/0.85):2 w l lw 2 lc rgb healthy title "healthy"
set title "damping: 0.98 and 0.2 of the limit"
plot "$work/damping" w l lw 2 lc rgb sick title "fails", \
     "$work/damping_healthy" u (\$1*0.2/0.98):2 w l lw 2 lc rgb healthy title "healthy"
set title "stiff hold: dt = 0.0188 and 0.0047"
plot [][1e-3:] "$work/stiff_hold" w l lw 2 lc rgb sick title "fails", \
     "$work/stiff_hold_healthy" u (\$1/4):2 w l lw 2 lc rgb healthy title "healthy"
unset logscale y
set format y "%g"
set ylabel "change of the energy / J"
set xtics 2000
set title "force jump: cut off and led to 0"
plot "$work/force_jump" u 1:(\$2-($(first force_jump))) w l lw 2 lc rgb sick title "fails", \
     "$work/force_jump_healthy" u 1:(\$2-($(first force_jump_healthy))) w l lw 2 lc rgb healthy title "healthy"
set xtics autofreq
set ylabel "force on the press / N"
set title "constraint work: moved and moved by force"
plot "$work/constraint_work" w l lw 2 lc rgb sick title "fails", \
     "$work/constraint_work_healthy" w l lw 2 lc rgb healthy title "healthy"
set ylabel "change of the energy / J"
set title "heating: 8 and 18 value bits"
plot "$work/heating" u 1:(\$2-($(first heating))) w l lw 2 lc rgb sick title "fails", \
     "$work/heating_healthy" u 1:(\$2-($(first heating_healthy))) w l lw 2 lc rgb healthy title "healthy"
PLOT
