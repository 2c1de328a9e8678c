#!/bin/sh
# SPDX-License-Identifier: MIT
# example.sh EMIT_CASE COMMITTED DIR: re-emits the committed example, twice, and compares byte by byte.
set -eu
rm -rf "$3"
"$1" example "$3" 2
"$1" example "$3" 2
diff -r "$2" "$3"
