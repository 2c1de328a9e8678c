#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The walk through one change in CONTRIBUTING.md, in a copy of the tree: each block runs and prints what the page says.
# usage: walk.sh ROOT [cheap]    cheap: without the blocks that build, which take minutes
set -euo pipefail
root=$1 which=${2:-all}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null GIT_CEILING_DIRECTORIES=$work
export GIT_{AUTHOR,COMMITTER}_NAME=n GIT_{AUTHOR,COMMITTER}_EMAIL=e
unset GIT_DIR GIT_WORK_TREE
if git -C "$root" rev-parse --show-prefix 2>/dev/null | grep -qx ''; then
  git -C "$root" ls-files --cached --others --exclude-standard
else
  (cd "$root" && find . -path './build*' -prune -o -name node_modules -prune -o -type f -print)
fi >"$work/files"
mkdir "$work/tree"
(cd "$root" && while IFS= read -r file; do [ ! -e "$file" ] || printf '%s\n' "$file"; done <"$work/files" | tar -cf - -T -) | tar -xf - -C "$work/tree"
git -C "$work/tree" init -q
git -C "$work/tree" add --all
git -C "$work/tree" commit -qm tree

sed -n '/^## One change/,/^## Style/p' "$root/CONTRIBUTING.md" >"$work/walk.md"
blocks=11 texts=6
if [ "$which" = cheap ]; then
  # With a block that builds goes the text of what it prints.
  awk '/^```/ && !inside {inside = 1; kind = $0; block = $0; next}
    inside {block = block "\n" $0
      if ($0 == "```") {
        inside = 0
        if (kind == "```sh") builds = block ~ /build\/|cmake/
        if (!builds) print block
      }}' "$work/walk.md" >"$work/cheap.md"
  mv "$work/cheap.md" "$work/walk.md"
  blocks=5 texts=1
fi
IN=$work/tree bash "$root/tests/cli/guide.sh" "$work" "$work" walk.md $blocks $texts
