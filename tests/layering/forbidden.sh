#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The layering check must see a forbidden edge: a copy of the tree with one such include has to fail, naming it.
set -euo pipefail
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
for d in model hw rtl synth emu study gpu_ref cli tests; do
  [ ! -d "$1/$d" ] || tar -C "$1" --exclude=node_modules -cf - "$d" | tar -C "$copy" -xf -
done
echo '#include "hw/plan.h"' >> "$copy/model/contract/state.h"
if out=$(bash "$1/tests/layering/layering.sh" "$copy"); then
  echo "a forbidden include was not seen"; exit 1
fi
grep -q 'model/contract/state.h:[0-9]*: model/contract must not include hw/plan.h' <<<"$out"
