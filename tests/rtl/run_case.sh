#!/bin/sh
# SPDX-License-Identifier: MIT
# run_case.sh EMIT_CASE CASE STEPS DIR [MUTATION] TARGET...: emits a case, breaks it in one way if asked, runs the targets
# of its Makefile. A mutation must turn the bench red and name a place: then the exit status is 0.
#   mutations: table, law, rounding, drift, residue, record, link
set -u
# The bench runs for some cycles: what does not run in each of them is not to be optimised.
export MAKEFLAGS='OPT_SLOW=-O0 OPT_GLOBAL=-O0'
if command -v ccache >/dev/null; then export OBJCACHE=ccache; fi
emit=$1 case=$2 steps=$3 dir=$4 mutation=$5
shift 5
rm -rf "$dir"
"$emit" "$case" "$dir" "$steps" || exit 1
rtl=$dir/rtl
changed() { cmp -s "$1" "$1.before" && { echo "the mutation changed nothing in $1"; exit 1; }; rm "$1.before"; }
edit() { cp "$1" "$1.before"; sed -i "$2" "$1"; changed "$1"; }
case $mutation in
  none) ;;
  # The lowest bit of c0 in each entry of the force table.
  table) edit "$rtl/cuboct_force_rom.sv" 's/assign c0_o = data_q\[\([0-9]*\):0\];/assign c0_o = data_q[\1:0] ^ 1;/' ;;
  # All pairs have the first law.
  law) edit "$rtl/cuboct_pipe.sv" 's/assign address = {law, index};/assign address = {{LawWidth{1'"'"'b0}}, index};/' ;;
  # Truncation in place of rounding.
  rounding) edit "$rtl/cuboct_round_odd.sv" 's/{{(HighBits - 1) {1.b0}}, carry}/{HighBits{1'"'"'b0}}/' ;;
  # What v has below a unit of X is left out of the drift.
  drift) edit "$rtl/cuboct_update.sv" 's/) + drift;/) + $signed({drift[MovedBits-1:Guard], {Guard{1'"'"'b0}}});/' ;;
  # A particle that comes from another node has lost its residue.
  residue)
    edit "$rtl/cuboct_node_core.sv" \
      's/\.arrived_i(arrived)/.arrived_i(arrived \& ~({{(ParticleBits-Axes*Guard){1'"'"'b0}}, {(Axes*Guard){1'"'"'b1}}} << (IdLsb+IdBits)))/' ;;
  # The second record of each halo memory is not kept.
  record) edit "$rtl/cuboct_inbox.sv" 's/write_i(append_i), \(.*read_i(read_i)\)/write_i(append_i \&\& count_q != 1), \1/' ;;
  # A node hears its neighbour below x where it should hear the one above, and the other way round.
  link) edit "$rtl/cuboct_lattice.sv" 's/\.link_valid_i(valid_in)/.link_valid_i(valid_in ^ {valid_in[1] ^ valid_in[0], valid_in[1] ^ valid_in[0]})/' ;;
  *) echo "no mutation $mutation"; exit 2 ;;
esac
for target in "$@"; do
  out=$(make -s -C "$dir/bench" "$target" 2>&1)
  status=$?
  if [ "$mutation" = none ]; then
    if [ $status -ne 0 ]; then echo "$out" | grep -v sorry | tail -20; exit 1; fi
    case $target in
      verilator | icarus)
        echo "$out" | grep '^PASS [1-9][0-9]* comparisons' || { echo "$out" | tail -20; exit 1; } ;;
    esac
  else
    [ $status -eq 0 ] && { echo "the bench did not see the mutation"; exit 1; }
    echo "$out" | grep '^FAIL .*node [0-9]' || { echo "red, but no place:"; echo "$out" | tail -20; exit 1; }
  fi
done
