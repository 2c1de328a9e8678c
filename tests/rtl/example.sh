#!/bin/sh
# SPDX-License-Identifier: MIT
# example.sh EMIT_CASE COMMITTED RTL DIR: re-emits the committed example, twice, and compares byte by byte. The
# library's modules, which an emission copies, are compared with their originals; the commit holds the rest.
set -eu
rm -rf "$4"
"$1" example "$4" 2
"$1" example "$4" 2
# The pages that the modules' comments name are there, each word of them; links to pages that are not are gone.
grep -rhoE 'docs/[a-z/]+\.md' "$4" --include=*.sv --include=README.md | sort -u | while read -r page; do
  [ -s "$4/$page" ] || { echo "the project names $page and does not hold it"; exit 1; }
done
! grep -nE '\]\([^#)]' "$4"/docs/reference/*.md
rm -r "$4/docs"
for module in "$3"/lib/*/*.sv "$3"/lattice/*.sv; do
  copy="$4/rtl/$(basename "$module")"
  [ -e "$copy" ] || continue
  cmp "$module" "$copy"
  rm "$copy"
done
diff -r "$2" "$4"
