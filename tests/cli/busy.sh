#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests that start, interrupt and time programs pass on a busy machine too: each program of tests runs beside an endless
# loop for every core.
# usage: busy.sh PROGRAM...
set -euo pipefail
loops=()
trap 'kill "${loops[@]}"' EXIT
for _ in $(seq "$(nproc)"); do
  while :; do :; done &
  loops+=($!)
done
for program in "$@"; do
  "$program" --gtest_brief=1
done
