#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Each program's main begins with its standard streams (model/base/standard_streams.h), by itself or by front (cli/front.h), or
# fills their descriptors at least.
# usage: mains.sh ROOT; prints each main that does not and fails if there is one.
set -euo pipefail
cd "$1"
count=0 bad=0
while IFS= read -r file; do
  count=$((count + 1))
  body=$(sed -n '/^int main(/,/^}/p' "$file")
  grep -qE 'return (cuboct::)?(with_standard_streams|front)\(|^  cuboct::fill_standard_descriptors\(\);' <<<"$body" && continue
  echo "$file: main does not return with_standard_streams(...)"
  bad=1
done < <(grep -rlE --include='*.cpp' --include='*.cu' '^int main\(' model hw synth emu study cli python library 2>/dev/null)
[ "$count" -ge 8 ] || { echo "only $count programs found: the check sees nothing"; exit 1; }
[ "$bad" = 0 ] && echo "$count programs take their standard streams first"
exit "$bad"
