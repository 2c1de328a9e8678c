#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The scripts of tools/ parse, the list of packages holds names that dpkg could take, each once, tools/setup
# refuses a node that is too old before it installs anything, and tools/slowest names tests by their time.
# usage: scripts.sh ROOT
set -euo pipefail
cd "$1"
count=0
for script in tools/setup tools/build tools/test tools/demo .ci/run; do
  [ -x "$script" ] || { echo "$script cannot be run"; exit 1; }
  bash -n "$script"
  count=$((count + 1))
done
slowest=$(for n in 7 12 3; do
  printf ' %d/22 Test  #%d: a.b  # GetParam() = %d .....   Passed    %d.25 sec\n' "$n" "$n" "$n" "$n"
done | cat - <(printf '2/22 Test #2: c.d .....***Failed  5.50 sec\n\n95%% tests passed, 1 tests failed out of 22\n') | tools/slowest)
[ "$(tail -n 6 <<<"$slowest")" = "The slowest tests:
   12.25 s  a.b  # GetParam() = 12
    7.25 s  a.b  # GetParam() = 7
    5.50 s  c.d
    3.25 s  a.b  # GetParam() = 3
95% tests passed, 1 tests failed out of 22" ] || { echo "tools/slowest says: $slowest"; exit 1; }

names=$(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' tools/packages)
if grep -vE '^[a-z0-9][a-z0-9+.-]+$' <<<"$names"; then
  echo "tools/packages: not the name of a package"
  exit 1
fi
twice=$(sort <<<"$names" | uniq -d)
[ -z "$twice" ] || { echo "tools/packages lists twice: $twice"; exit 1; }

fakes=$(mktemp -d)
trap 'rm -rf "$fakes"' EXIT
for program in apt-get sudo npm; do
  printf '#!/bin/sh\necho "%s was called"; exit 1\n' "$program" >"$fakes/$program"
done
printf '#!/bin/sh\necho v16.20.2\n' >"$fakes/node"
chmod +x "$fakes"/*
if said=$(PATH=$fakes:$PATH tools/setup 2>&1) ||
  [ "$said" != "tools/setup: $fakes/node is v16.20.2; study/report/web needs Node.js 18 or later" ]; then
  echo "tools/setup with an old node: $said"
  exit 1
fi
echo "$count scripts and $(wc -l <<<"$names") packages"
