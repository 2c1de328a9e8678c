#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The layering check must see a forbidden edge: a copy of the tree with one such include has to fail, naming it.
set -euo pipefail
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
for d in model hw rtl synth emu study cli python library tests; do
  [ ! -d "$1/$d" ] || tar -C "$1" --exclude=node_modules -cf - "$d" | tar -C "$copy" -xf -
done
echo '#include "hw/plan/plan.h"' >> "$copy/model/contract/state.h"
echo '#include "cli/study/budget.h"' >> "$copy/cli/run/check.h"
echo '#include <CLI/App.hpp>' >> "$copy/cli/help.h"
if out=$(bash "$1/tests/layering/layering.sh" "$copy"); then
  echo "a forbidden include was not seen"; exit 1
fi
grep -q 'model/contract/state.h:[0-9]*: model/contract must not include hw/plan/plan.h' <<<"$out"
grep -q 'cli/run/check.h:[0-9]*: cli/run must not include cli/study/budget.h' <<<"$out"
grep -q 'cli/help.h: hw/program/options.cpp alone includes CLI11' <<<"$out"

# So must the check of columns see a line that is one too long.
printf '// %118s\n' x >> "$copy/rtl/lib/memories/cuboct_ram.sv"
if out=$(bash "$1/tests/layering/columns.sh" "$copy"); then
  echo "a line of 121 columns was not seen"; exit 1
fi
grep -q 'rtl/lib/memories/cuboct_ram.sv:[0-9]*: 121 columns' <<<"$out"

# And that of programs a main without its standard streams.
echo 'int main() { return 0; }' > "$copy/cli/other.cpp"
if out=$(bash "$1/tests/layering/mains.sh" "$copy"); then
  echo "a main without its standard streams was not seen"; exit 1
fi
grep -q 'cli/other.cpp: main does not return' <<<"$out"
