#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The tables of docs/synth_table.sh are of the RTL that is emitted now: their column RTL against the digest of each project.
# usage: fresh.sh CUBOCT ROOT WORK
set -euo pipefail
cuboct=$1 root=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
eval "$(sed -n '/^digest()/p' "$root/docs/synth_table.sh")"
seen=0 old=0
check() {  # TABLE, its row's first word, SCENE, ARGUMENTS of emit...
  local project=$work/project told now
  rm -rf "$project"
  told=$(awk -F'\t' -v row="$2" 'index($1, row) == 1 {print $NF}' "$root/docs/measured/data/$1.tsv")
  "$cuboct" emit "$root/scenes/$3.toml" "${@:4}" --out "$project" --vector-steps 1 > /dev/null
  now=$(digest "$project")
  seen=$((seen + 1))
  [ "$told" = "$now" ] || { echo "$1.tsv: $2 is of RTL '$told', which is now $now"; old=$((old + 1)); }
}
for target in ecp5-85 xc7; do
  for scene in coupon undamped_block lj_block sheet two_types; do check "synth-nodes-$target" $scene $scene; done
done
check rtl-small-fpgas UP5K coupon --arch "$root/scenes/archs/ice40.toml"
check rtl-small-fpgas HX8K coupon --arch "$root/scenes/archs/ice40_serial.toml"
for board in grips:icebreaker:icebreaker grips:board:ulx3s heat:icebreaker_heat:icebreaker; do
  IFS=: read -r scene arch board <<< "$board"
  check board-examples "\`$scene\`, \`archs/$arch.toml" "boards/$scene" --arch "$root/scenes/archs/$arch.toml" --board "$board" --unchecked
done
if [ $seen != 15 ] || [ $old != 0 ]; then
  echo "$old of $seen rows are stale: docs/synth_table.sh BUILD makes them anew"
  exit 1
fi
