#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The stages of cuboct synth: said before and after, gone on with after Ctrl-C, made anew where what they are made of has
# changed and not otherwise. The tools count their calls; one of them may be held.
# usage: stages.sh CUBOCT SOURCES WORK
set -euo pipefail
cuboct=$1 here=$2 work=$3
rm -rf "$work"
mkdir -p "$work/tools"
cd "$work"
export XDG_CACHE_HOME=$work/cache
fail() { echo "$1"; exit 1; }

: > hold
: > calls
for tool in yosys nextpnr-ice40 sta; do
  cat > tools/$tool <<TOOL
#!/bin/sh
case \$1 in -V | --version | -version) exec "$(command -v $tool)" "\$@" ;; esac
name=$tool
[ $tool != yosys ] || name=\$(basename "\$1" .ys)
[ "\$(cat "$work/hold")" != \$name ] || exec sleep 600
echo \$name >> "$work/calls"
exec "$(command -v $tool)" "\$@"
TOOL
done
chmod +x tools/*
PATH=$work/tools:$PATH
synth() { "$cuboct" synth project --target up5k --unit filter "$@" > printed 2> said; }
# What the tools were called for since the last time.
called() { [ "$(xargs < calls)" = "$1" ] || fail "called: $(xargs < calls), not $1"; : > calls; }
# Seconds and the numbers of a stage are those of tools.
said() { sed -E 's/[0-9]+ to [0-9]+ s/N to N s/; s/[0-9][0-9.,]*( s,|\/[0-9]| MHz| modules| bits of)/N\1/g' said | diff - <(printf '%s' "$1") || fail "said in other words"; }
interrupted() {  # the stage that is held
  local child code=0
  echo "$1" > hold
  "$cuboct" synth project --target up5k --unit filter --seed 3 > printed 2> said &
  child=$!
  until pgrep -P $child sleep > found; do
    kill -0 $child 2> gone || fail "it ended before sleep began: $(cat said printed)"
    sleep 0.1
  done
  kill -INT $child
  wait $child || code=$?
  [ $code = 1 ] && [ ! -s printed ] && [ ! -e project/synth ] || fail "an interrupt: exit $code, $(ls project)"
  : > hold
}

"$cuboct" emit "$here/sheet.toml" --arch "$here/narrow.toml" --out project --vector-steps 1 > printed
# Before the first stage has ended nothing is kept.
interrupted elaborate
said 'synth: elaboration (seconds), synthesis, clock estimate (seconds), placement, bitstream (seconds)
interrupted; nothing was written
'
called ''
interrupted synth
said "synth: elaboration (seconds), synthesis, clock estimate (seconds), placement, bitstream (seconds)
synth: elaboration: N s, N modules, N bits of cells; synthesis: N to N s
interrupted; nothing was written
  hint: the stages that ended are in $work/cache/cuboct/synth: the same command goes on from there
"
called elaborate
interrupted nextpnr-ice40
said "synth: synthesis (N to N s), clock estimate (seconds), placement, bitstream (seconds); known from before: elaboration
synth: synthesis: N s, LUT N/5280, FF N/5280
synth: clock estimate: N s, N MHz
interrupted; nothing was written
  hint: the stages that ended are in $work/cache/cuboct/synth: the same command goes on from there
"
called 'synth sta'
synth --seed 3 || fail "$(cat said)"
said 'synth: placement, bitstream (seconds); known from before: elaboration, synthesis, clock estimate
synth: placement: N s, Fmax N MHz
synth: bitstream: N s, N MHz by icetime
'
called nextpnr-ice40
mv project/synth/up5k/filter went_on

# The same without an interrupt, and nothing known.
XDG_CACHE_HOME=$work/other synth --seed 3
called 'elaborate synth sta nextpnr-ice40'
[ "$(wc -l < said)" = 6 ] || fail "said: $(cat said)"
for file in report.json table.txt netlist.v unit.asc unit.bin; do
  cmp went_on/$file project/synth/up5k/filter/$file
done
[ "$(ls went_on)" = "$(ls project/synth/up5k/filter)" ] || fail "other files: $(ls went_on)"

# All is known: nothing takes long, and nothing is said. stdout is the report's alone.
synth --seed 3 --json
called ''
[ ! -s said ] && cmp printed went_on/report.json || fail "a second time: $(cat said)"
# Placing has a seed and a frequency, which synthesis has not.
synth --seed 4
called nextpnr-ice40
synth --seed 3 --freq 20 --quiet
called nextpnr-ice40
[ ! -s said ] || fail "not quiet: $(cat said)"
# A comment is no code; another line is.
for file in project/rtl/*.sv; do echo '// of another plan' >> "$file"; done
synth --no-place
called ''
# The netlist is the same, and so is its clock.
echo 'module other; endmodule' >> project/rtl/cuboct_filter.sv
synth --no-place --json
called 'elaborate synth'
python3 -m json.tool printed > checked
# Another tool may make another netlist.
sed -i 's/-V | //; s/^name=/[ $1 != -V ] || { echo Yosys of today; exit; }\nname=/' tools/yosys
synth --no-place
called 'elaborate synth'
