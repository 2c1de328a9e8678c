#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# docs/reference/formal.md has a row for each proof of the table.
# usage: page.sh PYTHON PROVE PAGE
set -euo pipefail
bad=0
for proof in $("$1" "$2" --list --deep | sed 's,/.*,,' | sort -u); do
  grep -q "^| \`$proof\` |" "$3" || { echo "$3: no row for the proof '$proof'"; bad=1; }
done
exit $bad
