# SPDX-License-Identifier: MIT
"""First bending frequency of free beams: docs/measured/validation.md, section 5.

    python3 scenes/validation/beam.py BUILD OUT [JOBS]

prints the table and writes OUT/beam.dat and, for the picture, OUT/beam_theory.dat. Frequencies are over that of Euler and Bernoulli's beam.
"""
import os
import sys

import numpy as np

from frequency import free_beam, frequency, without_time_step
from runs import Curves, cuboct, in_parallel

COUNTS = (12, 20, 32, 52, 80, 128)  # particles in the longer rows of bonds
DT = 0.1414213562373095  # of the scene
# The section (docs/reference/physics.md): a row of bonds carries stiffness * pitch = 1 per strain and weighs 1 per
# length. 4 rows each at z = -sqrt(2), 0, sqrt(2) and 3 each at -+sqrt(1/2).
ROWS, SECOND_MOMENT = 18, 2 * 4 * 2.0 + 2 * 3 * 0.5
# kappa G A: 5/6 of the modulus C44 = stiffness/(sqrt(2) pitch) over pitch^2/sqrt(2) per row.
SHEAR = 5 / 6 * 0.5 * ROWS


def theories(count):
    """Length, and the frequencies of the two beams. The length is that which the particles fill in a row."""
    length = (12 * count + 6 * (count - 1)) / ROWS
    return (length, free_beam(length, SECOND_MOMENT, ROWS),
            free_beam(length, SECOND_MOMENT, ROWS, SHEAR, SECOND_MOMENT))


def slenderness_of(length):
    """Over the height of a rectangle of the same area and second moment, sqrt(12 I/A)."""
    return length / np.sqrt(12 * SECOND_MOMENT / ROWS)


def measured(build, out, name, count, speed, **kind):
    period = 2 * np.pi / theories(count)[2]
    middle = (count - 1) / 2
    ends = count / 50

    def box(low, high):
        return f'{{ shape = "box", min = [{low!r}, -9, -9], max = [{high!r}, 9, 9] }}'

    run = cuboct(build, "beam.toml", f"{out}/{name}_{count}", {
        "uniform # everything": f"[0, 0, {-speed!r}]",
        "uniform # the inner half": f"[0, 0, {2 * speed!r}]",
        "max": f"[{count - 0.9}, 3.1, 2.93]",
        "inner": box(middle - count / 4 + 0.1, middle + count / 4 - 0.1),
        "middle": box(middle - ends - 0.3, middle + ends + 0.3),
        "ends": f'{{ shape = "difference", from = {box(-1, count)}, minus = [{box(ends, count - 1 - ends)}] }}',
        "duration": 8 * period,
        "probe_every": max(1, round(period / DT / 60))}, **kind)
    curves = Curves(run)
    w, _ = frequency(curves.step * DT, curves["middle.z"] - curves["ends.z"])
    return without_time_step(w, DT)


def main():
    build, out = sys.argv[1], sys.argv[2]
    jobs = int(sys.argv[3]) if len(sys.argv) > 3 else os.cpu_count()
    kinds = {"default_5e-4": {"speed": 5e-4, "arch": "default.toml"},
             "wide_5e-4": {"speed": 5e-4, "arch": "wide.toml"},
             "wide_5e-5": {"speed": 5e-5, "arch": "wide.toml"}}
    work = [lambda count=count, name=name, kind=kind: measured(build, out, name, count, **kind)
            for count in COUNTS for name, kind in kinds.items()]
    results = in_parallel(jobs, work)
    with open(f"{out}/beam.dat", "w", encoding="utf-8") as table:
        print("# particles length/height w(Euler) " + " ".join(kinds) + " Timoshenko", file=table)
        for row, count in enumerate(COUNTS):
            length, euler, timoshenko = theories(count)
            values = [w / euler for w in results[row * len(kinds) : (row + 1) * len(kinds)]] + [timoshenko / euler]
            line = f"{count:4d} {slenderness_of(length):6.2f} {euler:.6e} " + " ".join(f"{value:.5f}" for value in values)
            print(line)
            print(line, file=table)
    with open(f"{out}/beam_theory.dat", "w", encoding="utf-8") as table:
        print("# length/height Timoshenko", file=table)
        for count in np.geomspace(11, 145, 60):
            length, euler, timoshenko = theories(count)
            print(f"{slenderness_of(length):.3f} {timoshenko / euler:.5f}", file=table)


if __name__ == "__main__":
    main()
