#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The program of docs/user/cpp.md builds, prints what the page says, and `cuboct run` ends with its hash.
# usage: page.sh ROOT COMPILER DIRECTORY_OF_LIBRARY            compiles it against a build directory's library
#        page.sh ROOT COMPILER BUILD_DIRECTORY installed       installs, and builds it by find_package(cuboct)
set -euo pipefail
root=$1 compiler=$2 place=$3 how=${4:-built}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Blocks whose first line names a file; the block without a language is what the program prints.
awk -v work="$work" '
  /^```/ { if (inside) { inside = 0; close(file) } else { inside = 1; file = ""; text = $0 == "```" } next }
  inside && text { print >(work "/expected") ; next }
  inside && file == "" { file = work "/" $2 }
  inside { print >file }' "$root/docs/user/cpp.md"
for file in CMakeLists.txt pull.cpp expected; do
  [ -s "$work/$file" ] || { echo "no $file on the page"; exit 1; }
done

if [ "$how" = installed ]; then
  cmake --install "$place" --strip --prefix "$work/prefix" >"$work/log"
  mv "$work/prefix" "$work/moved"  # it may stand anywhere
  cmake -S "$work" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/moved" -DCMAKE_CXX_COMPILER="$compiler" >"$work/log" || { cat "$work/log"; exit 1; }
  cmake --build "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
  program=$work/build/pull cuboct=$work/moved/bin/cuboct
  # Another minor version is another interface.
  sed 's/cuboct REQUIRED/cuboct 99.0 REQUIRED/' "$work/CMakeLists.txt" >"$work/other" && mkdir "$work/later" && mv "$work/other" "$work/later/CMakeLists.txt"
  cp "$work/pull.cpp" "$work/later"
  if cmake -S "$work/later" -B "$work/later/build" -DCMAKE_PREFIX_PATH="$work/moved" >"$work/log" 2>&1; then echo "version 99.0 was found"; exit 1; fi
  grep -q 'requested version "99.0"' "$work/log"
else
  for standard in 17 20; do
    "$compiler" -std=c++$standard -Wall -Wextra -Wpedantic -Werror -I "$root/library" "$work/pull.cpp" -o "$work/pull" -L "$place" -lcuboct -Wl,-rpath,"$place"
  done
  program=$work/pull cuboct=$place/../cuboct
fi
env -i "$program" "$root/scenes/coupon.toml" >"$work/printed"
diff "$work/expected" "$work/printed"
hash=$("$cuboct" run "$root/scenes/coupon.toml" --steps 400 --quiet | sed -n 's/^state hash *//p')
grep -qx "hash $hash" "$work/printed" || { echo "cuboct run ends with hash $hash"; exit 1; }
code=0
said=$(env -i "$program" nowhere.toml 2>&1) || code=$?
[ "$code" = 2 ] && [ "$said" = "nowhere.toml: cannot read this file" ] || { echo "exit code $code: $said"; exit 1; }
# What it offers is what the header says: no name of the inside, of which a program may have its own.
library=$place
[ "$how" = built ] || library=$work/moved/lib
others=$(nm -DC --defined-only "$library/libcuboct.so" | awk '$2 ~ /[TBD]/' | grep -vE ' [TBD] ((typeinfo|vtable) for )?cuboct::(Error|InputRefused|RunStopped|Simulation|crosscheck|look_for_programs_in|version)\b' || true)
[ -z "$others" ] || { echo "also offered: $others"; exit 1; }
cat "$work/printed"
