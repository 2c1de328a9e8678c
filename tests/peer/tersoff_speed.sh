#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Atom-steps per second of LAMMPS and of model/atoms/bond_order on one core each: the same atoms, the same steps of velocity
# Verlet at constant energy, in doubles.
#
#   tersoff_speed.sh PROGRAM [MATTER...]     PROGRAM: tersoff_speed of the build; MATTER: sheet silicon silicon_1988 (all)
#
# CUBOCT_SPEED_STEPS: steps of a measurement (60); CUBOCT_SPEED_ROUNDS: how often all are measured in turn (5).
#
# Time is that of the processor, user and system, of a run of STEPS + 5 steps less that of one of 5: reading, setup and
# first lists cancel, and so does what else the machine does. Each figure is the best of the rounds. LAMMPS has pair_style
# tersoff with three skins, the best of which counts, and tersoff/table, which interpolates in tables and has no other
# form than Tersoff's second. Debian's has no tersoff/omp, /intel or /opt.
set -euo pipefail
program=$1
shift
matters=("$@")
[ ${#matters[@]} -gt 0 ] || matters=(sheet silicon silicon_1988)
steps=${CUBOCT_SPEED_STEPS:-60}
rounds=${CUBOCT_SPEED_ROUNDS:-5}
lmp=$(command -v lmp || true)
potentials=${CUBOCT_POTENTIALS:-/usr/share/lammps/potentials}
[ -n "$lmp" ] && [ -f "$potentials/SiC.tersoff" ] || { echo "skipped: LAMMPS or its potential files are not installed"; exit 77; }
export OMP_NUM_THREADS=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/in.lmp" <<'END'
units metal
boundary p p ${third}
atom_style atomic
newton on
read_data ${data}
pair_style ${style}
pair_coeff * * ${file} ${element}
neighbor ${skin} bin
neigh_modify every 1 delay 0 check yes
fix nve all nve
timestep 0.001
thermo 1000000
run ${steps}
END

cpu() {  # command... -> seconds of the processor
  local TIMEFORMAT='%U %S' taken
  taken=$({ time "$@" >"$work/out" 2>"$work/err"; } 2>&1) || { cat "$work/out" "$work/err" >&2; exit 1; }
  awk '{print $1 + $2}' <<<"$taken"
}

lammps() {  # matter, style, skin, steps
  local third=p file=$potentials/SiC.tersoff element=Si
  case $1 in
    sheet) third=f element=C ;;
    silicon_1988) file=$potentials/Si.tersoff ;;
  esac
  cpu "$lmp" -in "$work/in.lmp" -log none -var third "$third" -var data "$work/$1.data" -var style "$2" -var file "$file" \
    -var element "$element" -var skin "$3" -var steps "$4"
}

rate() {  # matter, who -> atom-steps/s of one measurement
  local short long
  case $2 in
    cuboct) short=$(cpu "$program" "$1" 5) long=$(cpu "$program" "$1" $((steps + 5))) ;;
    *) short=$(lammps "$1" "${2%@*}" "${2#*@}" 5) long=$(lammps "$1" "${2%@*}" "${2#*@}" $((steps + 5))) ;;
  esac
  awk -v n="$atoms" -v s="$steps" -v t="$long" -v u="$short" 'BEGIN {printf "%.4g\n", (t > u ? n * s / (t - u) : 0)}'
}

version=$("$lmp" -h | sed -n 's/^Large-scale.*Simulator - //p')
echo "# $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), one core; LAMMPS of $version"
echo "# atom-steps per second of processor time, the best of $rounds rounds in turn"
printf '%-13s %8s %12s %6s %14s %12s %8s %8s\n' matter atoms tersoff skin tersoff/table cuboct ratio of_table
for matter in "${matters[@]}"; do
  "$program" "$matter" write "$work/$matter.data"
  atoms=$(awk '$2 == "atoms" {print $1; exit}' "$work/$matter.data")
  who=(cuboct tersoff@0.3 tersoff@1.0 tersoff@2.0)
  [ "$matter" = silicon_1988 ] || who+=(tersoff/table@0.3)
  declare -A best=()
  for ((round = 0; round < rounds; ++round)); do
    for one in "${who[@]}"; do
      best[$one]=$(awk -v a="$(rate "$matter" "$one")" -v b="${best[$one]:-0}" 'BEGIN {print (a > b ? a : b)}')
    done
  done
  plain=0 skin=''
  for one in tersoff@0.3 tersoff@1.0 tersoff@2.0; do
    if awk -v a="${best[$one]}" -v b="$plain" 'BEGIN {exit !(a > b)}'; then plain=${best[$one]} skin=${one#*@}; fi
  done
  awk -v m="$matter" -v n="$atoms" -v p="$plain" -v s="$skin" -v t="${best[tersoff/table@0.3]:-0}" -v c="${best[cuboct]}" \
    'BEGIN {printf "%-13s %8d %12.3g %6s %14s %12.3g %8.1f %8s\n", m, n, p, s, (t > 0 ? sprintf("%.3g", t) : "-"), c, c/p,
            (t > 0 ? sprintf("%.1f", c/t) : "-")}'
  unset best
done
