#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The C++ and CUDA sources are as clang-format leaves them, by the .clang-format of the root; and this test sees one that
# is not. Skipped without clang-format 14, which Debian 12 has: others set some lines differently.
# usage: format.sh ROOT
set -euo pipefail
root=$1
wanted=14
clang_format=$(command -v clang-format-$wanted || command -v clang-format || true)
if [ -z "$clang_format" ] || ! "$clang_format" --version | grep -q "version $wanted\."; then
  echo "skipped: no clang-format $wanted (apt-get install clang-format)"
  exit 77
fi

# Lists the files below a directory that are set otherwise.
unformatted() {
  local status=0 said
  said=$(cd "$1" && find . \( -path './build*' -o -name node_modules -o -name .git -o -path ./out \) -prune -o \
    -type f \( -name '*.cpp' -o -name '*.h' -o -name '*.cu' \) -print0 |
    xargs -0 "$clang_format" --dry-run -Werror 2>&1) || status=$?
  grep -oE '^[^ :]+:[0-9]+:[0-9]+: error' <<<"$said" | cut -d: -f1 | sort -u || true
  return $status
}

files=$(unformatted "$root") || {
  echo "$files"
  echo "not as clang-format sets them: clang-format -i FILE"
  exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$root/.clang-format" "$work"
echo 'int  a( int b ){return b;}' >"$work/bad.h"
echo 'int a(int b) { return b; }' >"$work/good.cpp"
if files=$(unformatted "$work") || [ "$files" != ./bad.h ]; then
  echo "a badly set file was not seen: '$files'"
  exit 1
fi
echo "all files are as clang-format sets them"
