#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs every sh block of a page in turn, in one directory, and finds every line of its plain blocks in what the block
# before printed. A systemverilog block is written to the file that its first line names: `// NAME`.
# usage: [IN=DIRECTORY] guide.sh ROOT DIRECTORY_OF_CUBOCT PAGE BLOCKS TEXTS [FILE...]
#   IN: the directory; else a new one, with ROOT's scenes
#   at least BLOCKS sh blocks and TEXTS plain ones stand on the page; the FILEs exist at the end
set -euo pipefail
root=$1 programs=$2 page=$1/$3 least_blocks=$4 least_texts=$5
shift 5
work=$(mktemp -d)
printed=$work/printed
trap 'rm -rf "$work"' EXIT
ln -s "$root/scenes" "$work/scenes"
cd "${IN:-$work}"
PATH=$programs:$PATH
# What Verilator makes runs for some cycles: its compiler is not to optimise.
export MAKEFLAGS='OPT_FAST=-O0 OPT_SLOW=-O0 OPT_GLOBAL=-O0'
if command -v ccache >/dev/null; then export OBJCACHE=ccache; fi

# A page's sleep of seconds lets a program in the background begin: here until it catches SIGTERM, however busy the machine is.
sleeps='sleep() {
  local program=$(jobs -p | tail -n 1)
  [ "${1%%.*}" -gt 0 ] || program=none
  while [ -d "/proc/${program:-none}" ] && ! (( 0x$(sed -n "s/^SigCgt:[[:space:]]*//p" "/proc/$program/status") >> 14 & 1 )); do
    command sleep 0.1
  done
  if [ "$program" = none ]; then command sleep "$1"; else command sleep 0.5; fi
}'
blocks=0 texts=0
kind='' body=''
while IFS= read -r line; do
  case "$kind:$line" in
    ':```sh') kind=sh body='' ;;
    ':```systemverilog') kind=file body='' ;;
    ':```') kind=text body='' ;;
    ':```'*) kind=other body='' ;;
    'sh:```')
      kind='' blocks=$((blocks + 1))
      bash -euo pipefail -c "$sleeps"$'\n'"$body" >"$printed" 2>&1 </dev/null || { echo "failed: $body"; cat "$printed"; exit 1; } ;;
    'file:```')
      kind='' name=${body%%$'\n'*}
      printf %s "$body" >"${name#// }" ;;
    'text:```')
      kind='' texts=$((texts + 1))
      while IFS= read -r expected; do
        grep -qxF -- "$expected" "$printed" || { echo "not printed: $expected"; cat "$printed"; exit 1; }
      done < <(printf %s "$body") ;;
    'other:```') kind='' ;;
    sh:* | file:* | text:*) body+=$line$'\n' ;;
  esac
done <"$page"
[ "$blocks" -ge "$least_blocks" ] && [ "$texts" -ge "$least_texts" ] ||
  { echo "only $blocks blocks and $texts texts found"; exit 1; }
for file; do test -s "$file"; done
echo "$blocks blocks ran, $texts texts matched"
