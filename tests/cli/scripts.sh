#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The scripts of tools/ parse, and the list of packages holds names that dpkg could take, each once.
# usage: scripts.sh ROOT
set -euo pipefail
cd "$1"
count=0
for script in tools/setup tools/build tools/test tools/demo .ci/run; do
  [ -x "$script" ] || { echo "$script cannot be run"; exit 1; }
  bash -n "$script"
  count=$((count + 1))
done
names=$(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' tools/packages)
if grep -vE '^[a-z0-9][a-z0-9+.-]+$' <<<"$names"; then
  echo "tools/packages: not the name of a package"
  exit 1
fi
twice=$(sort <<<"$names" | uniq -d)
[ -z "$twice" ] || { echo "tools/packages lists twice: $twice"; exit 1; }
echo "$count scripts and $(wc -l <<<"$names") packages"
