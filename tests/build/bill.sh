#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Each package that tools/setup installs has a licence and a reason, and one without them is seen; the bill of materials names
# all of them, and is the same twice. usage: bill.sh ROOT
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$1/tools/bill_of_materials" --check
for k in 1 2; do "$1/tools/bill_of_materials" 0.1.0 --out "$work/$k"; done
cmp "$work/1" "$work/2"
[ "$(head -1 "$work/1")" = "SPDXVersion: SPDX-2.3" ]
packages=$(grep -vc '^#' "$1/tools/licences")
[ "$(grep -c '^PackageLicenseDeclared: ' "$work/1")" -eq $((packages + 1)) ]
[ "$(grep -c '^Relationship: ' "$work/1")" -eq $((packages + 1)) ]
grep -qx 'Relationship: SPDXRef-cuboct CONTAINS SPDXRef-libhdf5-dev' "$work/1"

mkdir -p "$work/tree/study/report/web" "$work/tree/cli/view"
cp -r "$1/tools" "$work/tree"
for web in study/report/web cli/view/web; do
  mkdir -p "$work/tree/$web"
  cp "$1/$web/package.json" "$1/$web/package-lock.json" "$work/tree/$web"
done
echo libother-dev >>"$work/tree/tools/packages"
if said=$("$work/tree/tools/bill_of_materials" --check) || [ "$said" != "libother-dev: no line in tools/licences" ]; then
  echo "a package without a licence was not seen: $said"
  exit 1
fi
