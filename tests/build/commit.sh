#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What cli/commit.cmake writes for `cuboct --version`: git's word of the sources, "unknown" outside a repository and
# within another one; the file stays as it is where nothing changed.
# usage: commit.sh ROOT
set -euo pipefail
script=$1/cli/commit.cmake
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null GIT_CEILING_DIRECTORIES=$work
unset GIT_DIR GIT_WORK_TREE

tells() {  # EXPECTED SOURCES
  cmake -D OUT="$work/commit.cpp" -D DIR="$2" -P "$script"
  grep -qF "return \"$1\";" "$work/commit.cpp" || { echo "not $1: $(cat "$work/commit.cpp")"; exit 1; }
}
sources=$work/repository
mkdir -p "$sources/vendored" "$work/none"
tells unknown "$work/none"
cd "$sources"
git init -q
echo 1 >a
git add a
git -c user.name=n -c user.email=e commit -qm first
hash=$(git rev-parse --short HEAD)
tells "$hash" "$sources"
tells unknown "$sources/vendored"
git tag v0.1
tells v0.1 "$sources"
touch -d '2001-01-01' "$work/commit.cpp"
tells v0.1 "$sources"
[ "$(date -r "$work/commit.cpp" +%Y)" = 2001 ] || { echo "written again for nothing"; exit 1; }
echo 2 >a
tells v0.1-dirty "$sources"
echo "five commits told"
