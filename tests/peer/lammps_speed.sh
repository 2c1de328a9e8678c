#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Particle-steps per second of LAMMPS and of the lattice engine, on the same cores in the same minute: free FCC
# blocks of the same sizes, slightly warm, with 18 neighbours inside the cutoff of 1.6 nearest-neighbour spacings.
#
#   lammps_speed.sh DIRECTORY_OF_CUBOCT [SIZE...]        sizes: 32k 256k 2m (all without one)
#
# CUBOCT_SPEED_SECONDS: length of a measurement, about (1); CUBOCT_SPEED_CORES: how many "all" are.
#
# LAMMPS runs as its manual recommends for speed: pair_style lj/cut with -sf opt, newton on, neighbour lists checked
# every step after the tenth, no thermo output; one MPI rank per core. Its neighbour skin is the default of 0.3 sigma,
# and two that leave the third shell (at 1.73 spacings) out of the lists; the best of the three counts. Only the loop
# time of a second run is taken: setup and the first lists are outside. LAMMPS computes in doubles; cuboct in integers,
# with a spline's table instead of Lennard-Jones: both look up or evaluate one pair force per neighbour and step.
set -euo pipefail
programs=$1
shift
sizes=("$@")
[ ${#sizes[@]} -gt 0 ] || sizes=(32k 256k 2m)
seconds=${CUBOCT_SPEED_SECONDS:-1}
cores=${CUBOCT_SPEED_CORES:-$(nproc)}
lmp=$(command -v lmp || command -v lmp_mpi || true)
[ -n "$lmp" ] && command -v mpirun >/dev/null || { echo "skipped: LAMMPS or mpirun is not installed"; exit 77; }
export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Reduced units, lattice "fcc 1.0": spacing 2^(1/6), the minimum of the pair potential. The temperature gives
# amplitudes of about 1/150 of the spacing, as those of cuboct's block.
cat >"$work/in.lmp" <<'END'
units lj
boundary s s s
atom_style atomic
newton on
lattice fcc 1.0
region block block 0 ${cells} 0 ${cells} 0 ${cells} units lattice
create_box 1 block
create_atoms 1 box
mass 1 1.0
velocity all create 0.02 87287 loop geom
pair_style lj/cut 1.796
pair_coeff 1 1 1.0 1.0
neighbor ${skin} bin
neigh_modify every 1 delay 10 check yes
fix nve all nve
timestep 0.002
thermo 1000000
run ${warm}
run ${steps}
END

lammps() {  # cells, skin, ranks, steps -> atom-steps/s of the second run
  mpirun -n "$3" --oversubscribe "$lmp" -sf opt -in "$work/in.lmp" -log none \
    -var cells "$1" -var skin "$2" -var warm 20 -var steps "$4" >"$work/out" 2>&1 || { cat "$work/out" >&2; exit 1; }
  # A list that came too late would be a wrong run, and a fast one.
  awk '/^Loop time of/ {t=$4; s=$9; n=$12} /^Dangerous builds/ {late=$4} END {
         if (!(t > 0) || late != 0) exit 1; printf "%.6g", n*s/t}' "$work/out" ||
    { echo "no speed, or dangerous builds, in what LAMMPS says:" >&2; cat "$work/out" >&2; exit 1; }
}

cuboct() {  # size, benchmark's last word
  local name=lattice.block_$1.$2
  local threads=()
  [ "$2" = 1_thread ] || threads=(--threads "$cores")
  "$programs/cuboct" bench "$name" --seconds "$seconds" --repeats 3 "${threads[@]}" |
    awk -v name="$name.particle_steps" '$1 == name {print $2; found = 1} END {exit !found}'
}

version=$("$lmp" -h | sed -n 's/^Large-scale.*Simulator - //p')
echo "# $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), $cores cores; LAMMPS of $version"
echo "# particle-steps per second; LAMMPS by neighbour skin (sigma)"
printf '%-6s %5s %12s %12s %12s %9s %12s %8s\n' size cores skin_0.3 skin_0.12 skin_0.06 best cuboct ratio
for size in "${sizes[@]}"; do
  case $size in
    32k) cells=20 ;;
    256k) cells=40 ;;
    2m) cells=80 ;;
    *) echo "unknown size $size: 32k, 256k or 2m" >&2; exit 2 ;;
  esac
  counts=(1)
  [ "$cores" -eq 1 ] || counts+=("$cores")
  for ranks in "${counts[@]}"; do
    # A trial of 10 steps says how many make a measurement.
    rate=$(lammps "$cells" 0.12 "$ranks" 10)
    steps=$(awk -v r="$rate" -v c="$cells" -v s="$seconds" 'BEGIN {n = int(s*r/(4*c*c*c)); print n < 20 ? 20 : n}')
    best=0 best_skin='' row=()
    for skin in 0.3 0.12 0.06; do
      value=$(lammps "$cells" "$skin" "$ranks" "$steps")
      row+=("$value")
      if awk -v a="$value" -v b="$best" 'BEGIN {exit !(a > b)}'; then best=$value best_skin=$skin; fi
    done
    word=all_cores
    [ "$ranks" -ne 1 ] || word=1_thread
    ours=$(cuboct "$size" "$word")
    printf '%-6s %5d %12.4g %12.4g %12.4g %9s %12.4g %8.2f\n' "$size" "$ranks" "${row[@]}" "$best_skin" "$ours" \
      "$(awk -v a="$ours" -v b="$best" 'BEGIN {print a/b}')"
  done
done
