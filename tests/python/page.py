# SPDX-License-Identifier: MIT
"""Runs the Python blocks of docs/user/python.md, one after another.

usage: page.py ROOT DIRECTORY_OF_CUBOCT [without_view]; the latter of a build without the page of a run: blocks that show it are left out"""
import os
import re
import sys
import tempfile

root, programs, *without = sys.argv[1:]
os.environ["PATH"] = programs + ":" + os.environ["PATH"]
with open(os.path.join(root, "docs/user/python.md"), encoding="utf-8") as file:
    text = file.read()
names: dict = {}
blocks = 0
with tempfile.TemporaryDirectory() as folder:
    os.symlink(os.path.join(root, "scenes"), os.path.join(folder, "scenes"))
    os.chdir(folder)
    for found in re.finditer(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        line = text.count("\n", 0, found.start(1))
        if without and ".view(" in found[1]:
            print(f"line {line + 1}: left out, this build has no page of a run")
            continue
        exec(compile("\n" * line + found[1], "docs/user/python.md", "exec"), names)
        blocks += 1
    os.chdir("/")
assert blocks >= 9, f"only {blocks} blocks found"
print(f"{blocks} blocks ran")
