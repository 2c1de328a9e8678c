#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bond updates per second of LAMMPS's peri/lps and of model/rules/lps.h on one core each: the same free block of glass, the
# same steps of velocity Verlet, in doubles. A bond update is a step's two rounds of one bond.
#
#   lps_speed.sh PROGRAM [SIDE...]     PROGRAM: lps_speed of the build; SIDE: points along an edge of the block (20 30)
#
# CUBOCT_SPEED_STEPS: steps of a measurement (60); CUBOCT_SPEED_ROUNDS: how often both are measured in turn (5).
#
# Time is that of the processor, user and system, of a run of STEPS + 5 steps less that of one of 5. Each figure is the best
# of the rounds. Debian's LAMMPS has no other variant of the style.
set -euo pipefail
program=$1
shift
sides=("$@")
[ ${#sides[@]} -gt 0 ] || sides=(20 30)
steps=${CUBOCT_SPEED_STEPS:-60}
rounds=${CUBOCT_SPEED_ROUNDS:-5}
lmp=$(command -v lmp || true)
[ -n "$lmp" ] || { echo "skipped: LAMMPS is not installed"; exit 77; }
export OMP_NUM_THREADS=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cpu() {  # command... -> seconds of the processor
  local TIMEFORMAT='%U %S' taken
  taken=$({ time "$@" >"$work/out" 2>"$work/err"; } 2>&1) || { cat "$work/out" "$work/err" >&2; exit 1; }
  awk '{print $1 + $2}' <<<"$taken"
}
seconds() {  # who side steps -> of steps alone
  local short long
  if [ "$1" = cuboct ]; then
    short=$(cpu "$program" "$2" 5) long=$(cpu "$program" "$2" $(($3 + 5)))
  else
    short=$(cpu "$lmp" -in "$work/$2.lmp" -log none -var steps 5) long=$(cpu "$lmp" -in "$work/$2.lmp" -log none -var steps $(($3 + 5)))
  fi
  awk -v a="$long" -v b="$short" 'BEGIN {printf "%.4f\n", a - b}'
}

echo "# $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), one core; LAMMPS of $("$lmp" -h | sed -n 's/^Large-scale.*Simulator - //p')"
echo "# bond updates per second of processor time, the best of $rounds rounds in turn"
printf '%8s %9s %12s %12s %6s\n' points bonds peri/lps cuboct ratio
for side in "${sides[@]}"; do
  "$program" "$side" write "$work/$side.lmp"
  bonds=$("$program" "$side" 0 | awk '{print $3}')
  ours=1e9 theirs=1e9
  for ((round = 0; round < rounds; ++round)); do
    ours=$(awk -v a="$ours" -v b="$(seconds cuboct "$side" "$steps")" 'BEGIN {print (b > 0 && b < a ? b : a)}')
    theirs=$(awk -v a="$theirs" -v b="$(seconds lammps "$side" "$steps")" 'BEGIN {print (b > 0 && b < a ? b : a)}')
  done
  awk -v n=$((side * side * side)) -v b="$bonds" -v s="$steps" -v t="$theirs" -v o="$ours" \
    'BEGIN {printf "%8d %9d %12.3g %12.3g %6.1f\n", n, b, b * s / t, b * s / o, t / o}'
done
