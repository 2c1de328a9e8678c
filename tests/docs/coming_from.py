#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the inputs of docs/user/coming-from.md and holds the page's tables to what they give.

    coming_from.py ROOT DIRECTORY_OF_CUBOCT          each scene for some steps: the figures of the start
    coming_from.py ROOT DIRECTORY_OF_CUBOCT whole    all figures, and those of LAMMPS where it is installed

A figure of cuboct must be the one of the page to its last digit, as its bits are the same anywhere. One of another program must be as near to it
as the page says."""
import csv
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT, PROGRAMS = sys.argv[1:3]
WHOLE = sys.argv[3:] == ["whole"]
PAGE = os.path.join(ROOT, "docs/user/coming-from.md")
EV = 1.602176634e-19


def ours(name):
    with open(f"out/{name}/curves.csv", encoding="utf-8") as file:
        return [{key.split(" (")[0]: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]


def theirs(name):
    rows, names = [], None
    with open(f"log.{name}", encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["Step"]:
                names = words
            elif words[:1] == ["Loop"]:
                names = None
            elif names:
                rows.append(dict(zip(names, map(float, words))))
    assert rows, f"log.{name} has no table"
    return rows


def mean(rows, key, first, last, by="step"):
    values = [row[key] for row in rows if key in row and first <= row[by] <= last]
    assert len(values) > 10, (key, len(values))
    return sum(values) / len(values)


# By section's name and the first words of the figure: cuboct's from its rows, LAMMPS's from its rows. `start`: the first step has it.
FIGURES = {
    ("melt", "potential energy"): (True, lambda r: r[0]["energy.potential"] / 864, lambda r: r[0]["PotEng"]),
    ("melt", "energy of an atom"): (False, lambda r: r[-1]["energy.total"] / 864, lambda r: r[-1]["TotEng"]),
    ("melt", "mean temperature"): (False, lambda r: mean(r, "temperature", 1000, 3000), lambda r: mean(r, "Temp", 1000, 3000, "Step")),
    ("copper", "potential energy"): (True, lambda r: r[0]["energy.potential"] / EV / 864, lambda r: r[0]["PotEng"] / 864),
    ("copper", "energy of an atom"): (False, lambda r: r[-1]["energy.total"] / EV / 864, lambda r: r[-1]["TotEng"] / 864),
    ("copper", "mean temperature"): (False, lambda r: mean(r, "temperature", 250, 1000), lambda r: mean(r, "Temp", 250, 1000, "Step")),
    ("bath", "potential energy"): (True, lambda r: r[0]["energy.potential"] / 500, lambda r: r[0]["PotEng"]),
    ("bath", "mean temperature"): (False, lambda r: mean(r, "temperature", 1000, 4000), lambda r: mean(r, "Temp", 1000, 4000, "Step")),
    ("bath", "mean potential"): (False, lambda r: mean(r, "energy.potential", 1000, 4000) / 500, lambda r: mean(r, "PotEng", 1000, 4000, "Step")),
    ("dpd", "mean temperature"): (False, lambda r: mean(r, "temperature", 500, 2000), None),
    ("pull", "potential energy"): (True, lambda r: r[0]["energy.potential"] / 1013, lambda r: r[0]["PotEng"]),
    ("pull", "force on the moved"): (False, lambda r: r[-1]["grip.force"], lambda r: r[-1]["v_force"]),
    ("stretch", "potential energy"): (True, lambda r: r[0]["energy.potential"] / 864, lambda r: r[0]["PotEng"]),
    ("stretch", "length of the box"): (False, lambda r: 6 * 2**0.5 * 1.1 * (1 + r[-1]["box.strain_x"]), lambda r: r[-1]["Lx"]),
    ("stretch", "mean stress along x"): (False, lambda r: mean(r, "box.xx", 1000, 1500), lambda r: -mean(r, "Pxx", 1000, 1500, "Step")),
    ("stretch", "mean stress along y"): (False, lambda r: mean(r, "box.yy", 1000, 1500), lambda r: -mean(r, "Pyy", 1000, 1500, "Step")),
    ("plate", "mean force"): (False, lambda r: mean(r, "pull.force", 0.5e-6, 2.5e-6, "time"), None),
}


def sections(text):
    """(name, blocks, rows of its table) of each section with inputs; the name is that of its scene."""
    for part in re.split(r"^## ", text, flags=re.M)[1:]:
        blocks = re.findall(r"^```(\w+)\n(.*?)^```$", part, flags=re.M | re.S)
        scenes = [re.match(r"# (\w+)\.toml\n", body)[1] for kind, body in blocks if kind == "toml"]
        if scenes:
            yield scenes[0], blocks, re.findall(r"^\| (?!figure|-)(.*) \|$", part, flags=re.M)


def main():
    with open(PAGE, encoding="utf-8") as file:
        found = list(sections(file.read()))
    lammps = WHOLE and shutil.which("lmp")
    environment = {**os.environ, "PATH": PROGRAMS + ":" + os.environ["PATH"], "OMP_NUM_THREADS": "1"}
    seen, bad = set(), []
    for name, blocks, rows in found:
        for kind, body in blocks:
            if kind in ("toml", "lammps"):
                with open(body.split("\n", 1)[0].removeprefix("# "), "w", encoding="utf-8") as file:
                    file.write(body)
        for line in [line for kind, body in blocks if kind == "sh" for line in body.splitlines()]:
            if line.startswith("lmp") and not lammps:
                continue
            command = line + ("" if line.startswith("lmp") else " --quiet" + ("" if WHOLE else " --steps 25"))
            done = subprocess.run(command, shell=True, env=environment, capture_output=True, text=True, check=False)
            assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
        for row in rows:
            figure, their_text, our_text, tolerance, since = row.split(" | ")
            key = next(key for key in FIGURES if key[0] == name and figure.startswith(key[1]))
            start, of_ours, of_theirs = FIGURES[key]
            seen.add(key)
            assert since, row
            if abs(float(their_text) - float(our_text)) > float(tolerance):
                bad.append(f"{figure}: the page's figures differ by more than {tolerance}")
            if not (WHOLE or start):
                continue
            digits = len(our_text.partition(".")[2])
            value = of_ours(ours(name))
            print(f"{name}: {figure}: {value:.{digits + 2}f}")
            if f"{value:.{digits}f}" != our_text:
                bad.append(f"{figure}: cuboct's is {value:.{digits}f}, on the page {our_text}")
            if lammps and of_theirs:
                other = of_theirs(theirs(name))
                print(f"  LAMMPS: {other:.{digits + 2}f}")
                if abs(other - value) > float(tolerance) or abs(other - float(their_text)) > float(tolerance):
                    bad.append(f"{figure}: LAMMPS's is {other}, cuboct's {value}, on the page {their_text}")
    assert seen == set(FIGURES), f"not on the page: {set(FIGURES) - seen}"
    print("\n".join(bad) or f"{len(found)} inputs, {len(seen)} figures")
    return 1 if bad else 0


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(os.path.join(ROOT, "scenes"), os.path.join(folder, "scenes"))
        os.chdir(folder)
        code = main()
        os.chdir("/")
    sys.exit(code)
