# SPDX-License-Identifier: MIT
"""Fluctuation of the energy at constant energy against the time step: docs/measured/validation.md, section 1.

    python3 scenes/validation/nve.py BUILD OUT [JOBS]

prints the table and writes OUT/nve.dat. The first 20 units of time, in which the crystal melts, do not count.
"""
import os
import sys

import numpy as np

from runs import Curves, cuboct, in_parallel, lammps

MELT = 20.0
STEPS = (0.001, 0.002, 0.004, 0.008)
PAIR = "pair_style lj/smooth/linear 2.5\npair_coeff * * 1 1"
N = 4000


def fluctuation(time, energy, start=MELT):
    """Root mean square about the mean, that about the straight line, and the drift per unit of time; per particle."""
    time, energy = time[time >= start], energy[time >= start]
    line = np.polyfit(time, energy, 1)
    return energy.std(), (energy - np.polyval(line, time)).std(), line[0]


def ours(build, out, name, dt, length, **kind):
    every = round(0.1 / dt)
    run = cuboct(build, "melt.toml", f"{out}/{name}_{dt}",
                 {"dt": dt, "duration": MELT + length, "probe_every": every}, **kind)
    curves = Curves(run)
    return fluctuation(curves.step * dt, curves["energy.total"] / N)


def theirs(build, out, dt, length):
    start = cuboct(build, "melt.toml", f"{out}/start_{dt}", {"dt": dt, "duration": dt}, arch="wide.toml")
    rows = lammps(start, f"{out}/lammps_{dt}", PAIR, dt, round((MELT + length) / dt), round(0.1 / dt))
    return fluctuation(rows[:, 0] * dt, rows[:, 2])


def main():
    build, out = sys.argv[1], sys.argv[2]
    jobs = int(sys.argv[3]) if len(sys.argv) > 3 else os.cpu_count()
    kinds = [
        ("default", lambda dt: ours(build, out, "default", dt, 100, arch="default.toml")),
        ("D_20", lambda dt: ours(build, out, "D_20", dt, 100, arch="differences.toml")),
        ("wide", lambda dt: ours(build, out, "wide", dt, 100, arch="wide.toml")),
        # A fifth of the time: sums in doubles over cells take their time, and the fluctuation does not.
        ("reference", lambda dt: ours(build, out, "reference", dt, 20, engine="reference", arch="wide.toml")),
        ("LAMMPS", lambda dt: theirs(build, out, dt, 100)),
    ]
    work = [(name, dt, call) for name, call in kinds for dt in reversed(STEPS)]
    results = in_parallel(jobs, [lambda dt=dt, call=call: call(dt) for _, dt, call in work])
    with open(f"{out}/nve.dat", "w", encoding="utf-8") as table:
        for (name, dt, _), (rms, about_line, drift) in zip(work, results):
            line = f"{name:<10} {dt:.3f} {rms:.3e} {about_line:.3e} {drift:+.2e}"
            print(line)
            print(line, file=table)


if __name__ == "__main__":
    main()
