#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# `pip install .` as docs/user/python.md says, offline; the module then runs from anywhere.
# usage: install.sh ROOT PYTHON [BUILD_DIRECTORY]; without one, all is compiled once more
set -euo pipefail
root=$1 python=$2
unset CUBOCT_BUILD
[ $# -lt 3 ] || export CUBOCT_BUILD=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH
"$python" -m venv --system-site-packages "$work/venv"
"$work/venv/bin/pip" install --no-index --no-build-isolation "$root" >"$work/log" 2>&1 || { tail -n 50 "$work/log"; exit 1; }
cd "$work"
"$work/venv/bin/python" - "$root" "$work/venv" <<'PY'
import os
import sys

import cuboct

root, environment = sys.argv[1:]
assert cuboct.__file__.startswith(environment), cuboct.__file__
assert os.path.exists(os.path.join(os.path.dirname(cuboct.__file__), "py.typed"))
assert cuboct.crosscheck(f"{root}/scenes/lj_block.toml", ["golden", "lattice"], steps=5)
PY
echo "installed, and a crosscheck matched"
