# SPDX-License-Identifier: MIT
"""Temperature and pressure of a Lennard-Jones liquid beside LAMMPS: docs/measured/validation.md, section 3.

    python3 scenes/validation/melt.py BUILD OUT [JOBS]

prints the table and writes OUT/melt.dat. All runs begin alike; the first 20 units of time do not count.
"""
import os
import sys

import numpy as np

from nve import MELT, N, PAIR
from runs import Curves, blocked, cuboct, in_parallel, lammps

DT, LENGTH, EVERY = 0.004, 100, 25


def ours(build, out, name):
    run = cuboct(build, "melt.toml", f"{out}/{name}_{DT}", {"dt": DT, "duration": MELT + LENGTH, "probe_every": EVERY},
                 arch=f"{name}.toml")
    curves = Curves(run)
    return np.column_stack([curves.step * DT, curves["energy.kinetic"] / (1.5 * N), curves["pressure"],
                            curves["energy.total"] / N])


def theirs(build, out):
    start = cuboct(build, "melt.toml", f"{out}/start_{DT}", {"dt": DT, "duration": DT}, arch="wide.toml")
    rows = lammps(start, f"{out}/lammps_{DT}", PAIR, DT, round((MELT + LENGTH) / DT), EVERY)
    return np.column_stack([rows[:, 0] * DT, rows[:, 1] * (N - 1) / N, rows[:, 3], rows[:, 2]])


def report(names, runs, path):
    """LAMMPS takes the momentum's three degrees of freedom off its temperature; here all count."""
    means = {}
    with open(path, "w", encoding="utf-8") as table:
        for name, rows in zip(names, runs):
            rows = rows[rows[:, 0] >= MELT]
            means[name] = [blocked(rows[:, k]) for k in (1, 2)]
            (t, dt), (p, dp) = means[name]
            line = f"{name:<8} {t:.5f} {dt:.5f} {p:.5f} {dp:.5f} {rows[:, 3].mean():.6f}"
            (t0, dt0), (p0, dp0) = means[names[0]]
            if name != names[0]:
                line += f" {(t - t0) / np.hypot(dt, dt0):+.2f} {(p - p0) / np.hypot(dp, dp0):+.2f}"
            print(line)
            print(line, file=table)


def main():
    build, out = sys.argv[1], sys.argv[2]
    jobs = int(sys.argv[3]) if len(sys.argv) > 3 else os.cpu_count()
    names = ["LAMMPS", "default", "wide"]
    runs = in_parallel(jobs, [lambda: theirs(build, out), lambda: ours(build, out, "default"),
                              lambda: ours(build, out, "wide")])
    report(names, runs, f"{out}/melt.dat")


if __name__ == "__main__":
    main()
