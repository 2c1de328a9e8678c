#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# cuboct emit --fit: a scene of one cell on an iCE40UP5K, its arch made again; what is refused, word for word; an
# interrupt leaves nothing.
# usage: fit.sh CUBOCT SOURCES WORK
set -euo pipefail
cuboct=$1 here=$2 work=$3
rm -rf "$work"
mkdir -p "$work/tools"
cd "$work"
export XDG_CACHE_HOME=$work/cache
fail() { echo "$1"; exit 1; }
refused() {  # expected text; arguments of emit
  local code=0
  PATH=${tools:-$PATH} "$cuboct" emit "${@:2}" --out refused > printed 2> said || code=$?
  [ $code = 2 ] && [ ! -s printed ] || fail "not refused: $code $(cat printed said)"
  diff said <(printf '%s\n' "$1") || fail "refused in other words"
  [ ! -e refused ] || fail "a refusal leaves $(ls refused)"
}

cp "$here/lone.toml" "$here/narrow.toml" "$here/sheet.toml" .
"$cuboct" emit lone.toml --arch narrow.toml --fit up5k --out fitted > printed 2> said || fail "$(cat said)"
# What takes long is said before it begins, and each synthesis in a line when it is done.
diff <(sed -E 's/[0-9]+( s|\/)/N\1/g' said) - <<'SAID' || fail "said in other words"
fit: one synthesis: seconds for a small node, minutes for a large one
fit: 1: 1 x 1 x 1 cells a node, 1 lane, 1 pipe: N s, LUT N/5280, FF N/5280, DSP N/8, BRAM N/30, logic cells N/5280
SAID
grep -qE '^> 1 x 1 x 1 +1 +1 +1 +50 +[0-9]+ % +[0-9]+ % +[0-9]+ % +[0-9]+ % +[0-9]+ %  chosen$' printed || fail "$(cat printed)"
grep -qE '^synthesised      LUT [0-9]+/5280, FF [0-9]+/5280, DSP 5/8, BRAM [0-9]+/30, logic cells [0-9]+/5280$' printed ||
  fail "$(cat printed)"
grep -qx 'arch             fitted/arch.toml' printed || fail "$(cat printed)"
# The arch makes the same project; the second time it is known what a node takes.
"$cuboct" emit lone.toml --arch fitted/arch.toml --out again > again.printed
[ "$(sed 's/.* plan/plan/' again.printed)" = "$(tail -n 1 printed | sed 's/.* plan/plan/')" ] || fail "another plan"
diff -r -x .cuboct-emit -x arch.toml fitted again || fail "another project"
[ "$(ls cache/cuboct/fit | wc -l)" = 1 ] || fail "the cache has $(ls cache/cuboct/fit)"
mkdir none
printf '#!/bin/sh\n[ "$1" = -V ] && exec "%s" -V\nexit 9\n' "$(command -v yosys)" > none/yosys
chmod +x none/yosys
PATH=$work/none:$PATH "$cuboct" emit lone.toml --arch narrow.toml --fit up5k --out fitted > printed.again 2> said || fail "measured again"
[ ! -s said ] || fail "nothing takes long: $(cat said)"
cmp printed printed.again
# The choice of an earlier time is chosen anew, and said once.
cp fitted/arch.toml before.toml
"$cuboct" emit lone.toml --arch before.toml --fit up5k --out fitted > printed.again
cmp fitted/arch.toml before.toml
# An emission without --fit leaves the arch that it was given.
"$cuboct" emit lone.toml --arch narrow.toml --out fitted > again.printed
cmp fitted/arch.toml narrow.toml || fail "a stale arch.toml"
# A tool that fails.
code=0
PATH=$work/none:$PATH "$cuboct" emit lone.toml --arch narrow.toml --fit ecp5-25 --out failed > printed 2> said || code=$?
[ $code = 1 ] && [ ! -e failed ] && grep -q '^yosys failed:' said || fail "a broken yosys: $code $(cat said)"

refused "unknown target 'ecp5-35'
  hint: did you mean 'ecp5-25'? there are up5k, hx8k, ecp5-25, ecp5-85, xc7 and asic" lone.toml --fit ecp5-35
refused "--fit asic: standard cells have no limit to fit
  hint: --fit is for FPGAs" lone.toml --fit asic
refused "--fit xc7: the board ulx3s has another device
  hint: --fit ecp5-85" lone.toml --fit xc7 --board ulx3s
ln -s "$(command -v yosys)" tools/
tools=$work/tools refused "nextpnr-ice40 is not in PATH
  hint: apt-get install nextpnr-ice40" lone.toml --fit hx8k
rm tools/yosys
tools=$work/tools refused "yosys is not in PATH
  hint: apt-get install yosys" lone.toml --fit xc7
# Memories that have no room are told without a synthesis: how many words and bits there are, in blocks of 16 bits.
refused "sheet.toml: its 4 cells do not fit up5k: the nearest plan, 1 node of 2 x 2 x 1 cells with 1 lane and 1 pipe, \
takes BRAM 32/30 (1.07 times), LUT 584/5280, FF 452/5280, for its memories alone
  hint: --fit hx8k has room for these; about 2 cells would fit up5k, some 4 particles of this scene" \
  sheet.toml --arch narrow.toml --fit up5k
# The same of a machine whose formats and capacity are automatic.
refused "sheet.toml: its 4 cells do not fit up5k: the nearest plan, 1 node of 2 x 2 x 1 cells with 1 lane and 1 pipe, \
takes BRAM 67/30 (2.23 times), LUT 1532/5280, FF 1312/5280, for its memories alone
  hint: --fit ecp5-25 has room for these; not one cell fits up5k; the fullest cell holds 3 at the start, node.capacity is 16" \
  sheet.toml --fit up5k
[ "$(ls cache/cuboct/fit | wc -l)" = 1 ] || fail "a synthesis for what was known"
# Narrow memories have no other plan than their own, which is measured.
sed 's/capacity = 3/capacity = 3\nmemories = "narrow"/' narrow.toml > one_port.toml
code=0
"$cuboct" emit sheet.toml --arch one_port.toml --fit up5k --out refused > printed 2> said || code=$?
[ $code = 2 ] && [ ! -s printed ] && [ ! -e refused ] || fail "narrow memories: $code"
diff <(sed -E 's/[0-9.]+( times|\/| s,)/N\1/g' said) - <<'SAID'
fit: one synthesis: seconds for a small node, minutes for a large one
fit: 1: 1 x 1 x 1 cells a node, 1 lane, 1 pipe: N s, LUT N/5280, FF N/5280, DSP N/8, BRAM N/30, logic cells N/5280
sheet.toml: its 4 cells do not fit up5k with narrow memories: the nearest plan, 4 nodes of 1 x 1 x 1 cells with 1 lane and 1 pipe, takes LUT N/5280 (N times), DSP N/8 (N times), logic cells N/5280 (N times), FF N/5280, BRAM N/30
  hint: --fit ecp5-25 has room by these numbers; about 1 cell would fit up5k, some 2 particles of this scene; memories = "wide" have bricks
SAID
rm -r cache/cuboct/fit/*
mkdir refused.dir && touch refused.dir/mine
code=0
"$cuboct" emit lone.toml --fit xc7 --out refused.dir > printed 2> said || code=$?
[ $code = 2 ] && [ "$(ls refused.dir)" = mine ] || fail "somebody's directory: $code"
grep -qx 'refused.dir: is not empty and holds no earlier emission' said || fail "$(cat said)"

code=0
"$cuboct" emit lone.toml --fit xc7 --out refused.dir/mine/fit > printed 2> said || code=$?
[ $code = 2 ] || fail "a directory within a file: $code"
grep -qx "refused.dir/mine/fit: cannot be made, as $work/refused.dir/mine is no directory" said || fail "$(cat said)"

# An interrupt while yosys works. `stopped`: waits for a program below the command, and stops it.
stopped() {  # program; arguments of emit
  "$cuboct" emit "${@:2}" --out stopped > printed 2> said &
  local child=$! code=0
  until pgrep -P $child "$1" > found; do
    kill -0 $child 2> gone || fail "it ended before $1 began: $(cat said printed)"
    sleep 0.1
  done
  kill -INT $child
  wait $child || code=$?
  [ $code = 1 ] && [ ! -e stopped ] || fail "an interrupt: exit $code"
  grep -qx 'interrupted; nothing was written' said || fail "an interrupt: $(cat said)"
}
stopped yosys lone.toml --arch narrow.toml --fit hx8k
[ -z "$(ls cache/cuboct/fit)" ] || fail "an interrupt leaves something"
! grep -q hint said || fail "before the first synthesis nothing is kept: $(cat said)"

# After the first of several that one is kept, and the same command begins behind it. This yosys synthesises once.
mkdir second
cat > second/yosys <<END
#!/bin/sh
[ "\$1" = -V ] && exec "$(command -v yosys)" -V
[ ! -e "$work/first" ] || exec sleep 600
touch "$work/first"
exec "$(command -v yosys)" "\$@"
END
chmod +x second/yosys
PATH=$work/second:$PATH stopped sleep sheet.toml --arch narrow.toml --fit hx8k
diff <(sed -E 's/[0-9]+ s(,| each)/N s\1/g; s/LUT.*\/7680/USE/' said) - <<SAID || fail "an interrupt in other words"
fit: 3 to 18 syntheses, each of seconds for small nodes and minutes for large ones
fit: 1: 2 x 2 x 1 cells a node, 1 lane, 1 pipe: N s, USE; 15 more at most, of N s each so far
interrupted; nothing was written
  hint: the syntheses that ended are in $work/cache/cuboct/fit: the same command goes on from there
SAID
[ "$(ls cache/cuboct/fit | wc -l)" = 1 ] || fail "the first synthesis is gone"
PATH=$work/second:$PATH stopped sleep sheet.toml --arch narrow.toml --fit hx8k
diff said - <<SAID || fail "it does not go on"
fit: 3 to 18 syntheses, each of seconds for small nodes and minutes for large ones; 1 known from before
interrupted; nothing was written
SAID
