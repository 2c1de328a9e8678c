#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs every sh block of docs/user/guide.md in turn, and finds every text of its plain blocks in what the block before
# printed.
# usage: guide.sh ROOT DIRECTORY_OF_CUBOCT
set -euo pipefail
root=$1 programs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$root/scenes" "$work/scenes"
cd "$work"
PATH=$programs:$PATH

blocks=0 texts=0
kind='' body=''
while IFS= read -r line; do
  case "$kind:$line" in
    ':```sh') kind=sh body='' ;;
    ':```') kind=text body='' ;;
    'sh:```')
      kind='' blocks=$((blocks + 1))
      bash -euo pipefail -c "$body" >printed 2>&1 </dev/null || { echo "failed: $body"; cat printed; exit 1; } ;;
    'text:```')
      kind='' texts=$((texts + 1))
      while IFS= read -r expected; do
        grep -qxF -- "$expected" printed || { echo "not printed: $expected"; cat printed; exit 1; }
      done < <(printf %s "$body") ;;
    sh:* | text:*) body+=$line$'\n' ;;
  esac
done <"$root/docs/user/guide.md"
[ "$blocks" -ge 7 ] && [ "$texts" -ge 2 ] || { echo "only $blocks blocks and $texts texts found"; exit 1; }
test -s out/tour/report.html
echo "$blocks blocks ran, $texts texts matched"
