#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A man page for the command and for each of its commands: with all options that help tells, and nothing that man or mandoc warns of.
# usage: man_pages.sh ROOT CUBOCT
set -euo pipefail
root=$1 cuboct=$2
command -v man >/dev/null || { echo "skipped: no man (apt-get install man-db)"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake -D PROGRAM="$cuboct" -D OUT="$work/man" -P "$root/tools/man_pages.cmake"

pages=0 options=0
while IFS=$'\t' read -r command about; do
  case "$about" in *'left out: '*) continue ;; esac
  page=$work/man/cuboct-$command.1
  [ -s "$page" ] || { echo "no page of $command"; exit 1; }
  pages=$((pages + 1))
  MANWIDTH=10000 man -l "$page" >"$work/text" 2>/dev/null
  grep -q "^ *cuboct-$command - " "$work/text" || { echo "$page: no name"; exit 1; }
  for option in $("$cuboct" "$command" --help | grep -oE '^  (-[a-z], )?--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
    options=$((options + 1))
    grep -qE -- "^ *(-[a-z], )?$option( |\$)" "$work/text" || { echo "$page: no $option"; exit 1; }
  done
done < <("$cuboct" --help-as words | grep -v '^-')
[ "$pages" -ge 10 ] && [ "$options" -ge 100 ] || { echo "only $pages pages and $options options seen"; exit 1; }
# A backslash, a point at a line's begin: none is lost. The same bytes at each time.
for page in "$work"/man/*; do
  said=$(LC_ALL=C.UTF-8 MANROFFSEQ='' man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)
  [ -z "$said" ] || { echo "$page: $said"; exit 1; }
done
cmake -D PROGRAM="$cuboct" -D OUT="$work/again" -P "$root/tools/man_pages.cmake"
diff -r "$work/man" "$work/again"
# mandoc wants the day of a page; ours have a version instead.
if command -v mandoc >/dev/null; then
  if mandoc -T lint -W warning "$work"/man/* 2>&1 | grep -v 'missing date, using ""'; then exit 1; fi
fi
said=$("$cuboct" run --help-as html 2>&1) && exit 1
[ "$said" = "unknown form of help 'html'
  hint: one of man or words" ] || { echo "$said"; exit 1; }
echo "$pages pages with $options options"
