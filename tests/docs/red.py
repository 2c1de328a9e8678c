#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The checks of the pages see what they look for: each, on a copy of the tree with one defect, fails and names it.

    red.py ROOT"""
import pathlib
import shutil
import subprocess
import sys
import tempfile


def appended(text):
    return lambda old: old + text


DEFECTS = [  # check, page, what is done to it, what must be printed
    ("prose.py", "docs/glossary.md", appended("\n" + "word " * 30 + "end.\n"), "31 words, more than 30"),
    ("prose.py", "docs/glossary.md", appended("\n- An item.\n  " + "word " * 30 + "end.\n"), "31 words, more than 30"),
    ("prose.py", "docs/glossary.md", appended("\n" + "x" * 80 + " " + "y" * 80 + "\n"), "161 columns, more than 160"),
    ("links.py", "docs/glossary.md", appended("\n[gone](user/gone.md)\n"), "no file user/gone.md"),
    ("links.py", "docs/glossary.md", appended("\n[gone](user/scene.md#gone)\n"), "no heading user/scene.md#gone"),
    ("links.py", "docs/README.md", lambda old: old.replace("user/budget.md", "user/study.md"),
     "does not map docs/user/budget.md"),
    ("tables", "docs/measured/data/timing-cost.tsv", lambda old: old.replace("440", "441"), "differs from its data"),
    ("tables", "docs/measured/timing.md", lambda old: old.replace("440", "441"), "differs from its data"),
    ("tables", "docs/measured/data/timing-cost.tsv", lambda old: old.replace("# machine", "# host"), "expected '# machine: "),
]


def run(root, check):
    command = [root / "docs/tables", "--check"] if check == "tables" else [root / "tests/docs" / check, root]
    result = subprocess.run(command, capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


def main(root):
    failed = 0
    with tempfile.TemporaryDirectory() as work:
        tree = pathlib.Path(work) / "tree"
        of_root = shutil.ignore_patterns(".git", "build*", "out")
        anywhere = shutil.ignore_patterns("node_modules", "__pycache__")
        shutil.copytree(root, tree, ignore=lambda path, names: anywhere(path, names) | (of_root(path, names) if path == str(root) else set()))
        for check, page, change, expected in DEFECTS:
            path = tree / page
            old = path.read_text()
            new = change(old)
            assert new != old, f"{page}: nothing to change"
            path.write_text(new)
            status, printed = run(tree, check)
            path.write_text(old)
            if status == 0 or expected not in printed:
                print(f"{check} does not see: {expected}\n{printed[-2000:]}")
                failed += 1
        for check in sorted({defect[0] for defect in DEFECTS}):
            status, printed = run(tree, check)
            if status != 0:
                print(f"{check} is red without a defect\n{printed[-2000:]}")
                failed += 1
    print(f"{len(DEFECTS)} defects, {failed} failures")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
