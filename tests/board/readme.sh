#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# readme.sh run|build ROOT DIRECTORY_OF_CUBOCT CACHE: does what the README of an emitted board says, word for word: `run` the
# commands without a board, `build` those that make a bitstream (the ULX3S's up to yosys where there is no placer).
set -euo pipefail
what=$1 root=$2
export PATH=$3:$PATH XDG_CACHE_HOME=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
scene=$root/scenes/boards/grips.toml
fail() { echo "$1"; exit 1; }
# blocks PROJECT WORD: the blocks of the README that hold the word, in turn.
blocks() {
  awk -v word="$2" '/^```/ {if (inside && index(block, word)) printf "%s", block; inside = !inside; block = ""; next}
    inside {block = block $0 "\n"}' "$1/README.md"
}

emit() {  # BOARD ARCH ARGUMENT...
  cuboct emit "$scene" --arch "$root/scenes/archs/$2.toml" --board "$1" --out "$1" "${@:3}"
  cmp "$1/arch.toml" "$root/scenes/archs/$2.toml"
}

if [ "$what" = run ]; then
  # The machine of docs/user/board.md, which is compiled once.
  emit icebreaker icebreaker --baud 3000000 --unchecked
  blocks icebreaker cuboct-board-sim | sed "s|SCENE|$scene|" > commands
  [ "$(wc -l < commands)" = 4 ] || fail "other commands: $(cat commands)"
  (cd icebreaker && bash -euo pipefail ../commands > ../printed 2>&1) || fail "$(cat printed)"
  grep -qE '^plan hash +[0-9a-f]{16}$' printed || fail "$(cat printed)"
  # Golden's momentum, forces and energies, to the last digit.
  cuboct run "$scene" --arch icebreaker/arch.toml --engine golden > told
  same() { grep -E '^(momentum change|grip\.force|energy|temperature|plan hash)' "$1" | tr -s ' '; }
  [ "$(same told | wc -l)" = 8 ] || fail "golden tells $(same told)"
  diff <(same printed) <(same told) || fail "another run than golden's"
  exit
fi

emit icebreaker icebreaker
blocks icebreaker icepack > commands
[ "$(wc -l < commands)" = 3 ] || fail "other commands: $(cat commands)"
(cd icebreaker && bash -euo pipefail ../commands > ../printed 2>&1) || fail "$(tail -n 20 printed)"
[ "$(stat -c %s icebreaker/board/top.bin)" = 104090 ] || fail "the bitstream is not as long as that of an UP5K"
grep -q 'Max frequency for clock.*PASS at 12.00 MHz' printed || fail "$(grep 'Max frequency' printed)"
# The other way that the README names.
(cd icebreaker && cuboct synth . --target up5k --unit board > ../printed)
grep -qE '^fit the device +1 of board' printed || fail "$(cat printed)"
[ -s icebreaker/synth/up5k/board/unit.bin ] || fail "no bitstream"

emit ulx3s board
blocks ulx3s ecppack > commands
command -v nextpnr-ecp5 > /dev/null || sed -i '/^nextpnr-ecp5/,$d' commands
(cd ulx3s && bash -euo pipefail ../commands > ../printed 2>&1) || fail "$(tail -n 20 printed)"
[ -s ulx3s/board/top.json ] || fail "no netlist"

# Two nodes of it have no room: refused with what they take, and nothing is written.
code=0
cuboct emit "$scene" --arch "$root/scenes/archs/board.toml" --board icebreaker --out large > printed 2> said || code=$?
if [ $code != 2 ] || [ -s printed ] || [ -e large ]; then fail "not refused: $code $(cat printed said)"; fi
sed -E "s|$scene|SCENE|; s/[0-9]+\\//N\\//g" said | diff - <(cat <<SAID
fit: a synthesis for up5k: seconds for small nodes, minutes for large ones
SCENE: its 2 nodes and a host link do not fit the icebreaker (up5k): they take DSP N/8, BRAM N/30, logic cells N/5280, LUT N/5280, FF N/5280
  hint: not one such node fits; --fit up5k looks for a machine that fits, --unchecked writes this one for the simulator
SAID
) || fail "refused in other words: $(cat said)"
