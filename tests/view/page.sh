#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The page of a saved run in a browser, that of two runs, and the server. With `whole` also one of doubles, and pages of the server: a stored run, live ones.
# usage: page.sh quick|whole ROOT CUBOCT NODE CHROMIUM [PICTURES]
set -euo pipefail
tier=$1 root=$2 cuboct=$3 node=$4 chromium=$5 pictures=${6-}
here=$root/tests/view study_web=$root/study/report/web
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

saved() {  # NAME SCENE WORDS...
  local name=$1 scene=$2
  shift 2
  "$cuboct" run "$root/$scene" --quiet --frames none --out "$work/$name" "$@" >/dev/null
  "$cuboct" view "$work/$name" --save "$work/$name.html"
  /usr/bin/python3 "$here/trace_numbers.py" "$work/$name" >"$work/$name.json"
  if [ -n "$pictures" ]; then mkdir -p "$pictures/$name"; fi
  "$node" "$here/saved_page_test.mjs" "$work/$name.html" "$work/$name.json" "$chromium" "$study_web" ${pictures:+"$pictures/$name"}
}

saved words scenes/two_types.toml --steps 60 --frame-every 30 --cycles

compared() {  # NAME SCENE WORDS...: beside the run "words"
  local name=$1 scene=$2
  shift 2
  "$cuboct" run "$scene" --quiet --frames none --out "$work/$name" "$@" >/dev/null
  "$cuboct" view "$work/words" --with "$work/$name" --save "$work/$name.html"
  for one in words "$name"; do /usr/bin/python3 "$here/trace_numbers.py" "$work/$one" all >"$work/all/$one.json"; done
  "$node" "$here/compare_page_test.mjs" "$work/$name.html" "$work/all/words.json" "$work/all/$name.json" "$chromium" "$study_web" ${pictures:+"$pictures"}
}

mkdir "$work/all"
# The same body, pulled faster: equal at first.
sed 's/velocity = "\[20, 0, 40\] mm\/s"/velocity = "[20, 0, 44] mm\/s"/' "$root/scenes/two_types.toml" >"$work/faster.toml"
compared faster "$work/faster.toml" --steps 30 --frame-every 15
browser=-
if [ "$tier" = whole ]; then
  compared golden "$root/scenes/two_types.toml" --steps 60 --frame-every 20 --engine golden
  saved doubles scenes/lj_block.toml --steps 40 --frame-every 20 --engine reference
  browser=$chromium
fi
# Its temperature is read at each frame at least, energies at every second reading.
sed 's/^steps = 1000/&\nprobe_every = 25\nenergy_every = 50/' "$root/scenes/lj_block.toml" >"$work/live.toml"
printf '\n[[probe]]\nname = "block"\nkind = "temperature"\nregion = { shape = "sphere", radius = 100 }  # all\n' >>"$work/live.toml"
"$node" "$here/served_page_test.mjs" "$cuboct" "$work/words" "$work/words.json" "$work/live.toml" "$work/live" "$browser" "$study_web" \
  ${pictures:+"$pictures"}
# A bar under tension, whose report has a picture that turns.
"$cuboct" run "$root/scenes/coupon.toml" --steps 400 --quiet --frames none --out "$work/bar" >/dev/null
"$cuboct" report "$work/bar" >/dev/null
"$node" "$here/report_page_test.mjs" "$work/bar/report.html" "$chromium" "$study_web" ${pictures:+"$pictures"}
