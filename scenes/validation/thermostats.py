# SPDX-License-Identifier: MIT
"""Temperature, pressure and diffusion of thermostatted liquids beside LAMMPS: docs/measured/validation.md, section 6.

    python3 scenes/validation/thermostats.py BUILD OUT [JOBS [LIQUID...]]

prints the table and writes OUT/thermostats.dat. All runs of a liquid begin alike; the first 20 units of time do not count. LAMMPS must have the
package DPD-BASIC for dissipative particles, which Debian's lacks: the variable LMP names another `lmp`.
"""
import os
import sys

import h5py
import numpy as np

from runs import HERE, Curves, blocked, cuboct, first_frame, in_parallel, lammps

MELT = 20.0
# Name, rule, parameters, dt, length, lags of the diffusion, LAMMPS's pair style and thermostat.
LJ = ("pair_style lj/cut 2.5\npair_coeff * * 1 1", "fix bath all langevin 1 1 {damp} 48279")
DPD = ("comm_modify vel yes\npair_style dpd 1 1 34387\npair_coeff * * 25 4.5 1", "")
LIQUIDS = [
    ("langevin 0.005", "langevin", "", 0.005, 400, (2, 6), LJ[0], LJ[1].format(damp=1)),
    ("langevin 0.01", "langevin", "", 0.01, 400, (2, 6), LJ[0], LJ[1].format(damp=1)),
    ("langevin 0.005, friction 10", "langevin", "friction = 10", 0.005, 400, (2, 6), LJ[0], LJ[1].format(damp=0.1)),
    ("dpd 0.01", "dpd", "", 0.01, 1200, (1, 3), *DPD),
    ("dpd 0.02", "dpd", "", 0.02, 1200, (1, 3), *DPD),
    ("dpd 0.04", "dpd", "", 0.04, 1200, (1, 3), *DPD),
]
FRAME = 0.2  # time between frames: no particle goes half a box


def diffusion(x, box, lags):
    """(MSD(b) - MSD(a)) / 6 (b - a) of independent windows of length b: mean and standard error."""
    hop = np.diff(x, axis=0)
    path = np.concatenate([np.zeros_like(x[:1]), np.cumsum(hop - box * np.round(hop / box), axis=0)])
    a, b = (round(lag / FRAME) for lag in lags)
    begins = range(0, len(x) - b, b)
    far = [[((path[k + lag] - path[k]) ** 2).sum(axis=1).mean() for lag in (a, b)] for k in begins]
    values = np.diff(np.array(far), axis=1)[:, 0] / (6 * (lags[1] - lags[0]))
    return values.mean(), values.std(ddof=1) / np.sqrt(len(values))


def scene(build, out, liquid, length):
    _, rule, parameters, dt, _, _, _, _ = liquid
    text = f'{{ file = "{HERE}/../rules/texts/{rule}.toml", parameters = {{ {parameters} }} }}'
    every = round(FRAME / dt)
    return cuboct(build, f"../rules/{rule}.toml", out,
                  {"rule": text, "cells": "[6, 6, 6]", "dt": dt, "steps": round(length / dt), "probe_every": every,
                   "frame_every": every})


def ours(build, out, liquid):
    length = MELT + liquid[4]
    run = scene(build, f"{out}/{liquid[0]}", liquid, length)
    curves, first = Curves(run), round(MELT / FRAME)
    with h5py.File(os.path.join(run, "trace.h5")) as trace:
        x = trace["bodies"]["x"][:].reshape(-1, 864, 3)[first:]
    name = "liquid" if liquid[1] == "langevin" else "fluid"
    return (blocked(curves[f"{name}.temperature"][first:]), blocked(pressure(curves)),
            diffusion(x, first_frame(run)[0], liquid[5]))


def pressure(curves):
    values = curves["pressure"]
    return values[len(values) // 20:]


def theirs(build, out, liquid):
    _, rule, _, dt, length, lags, pair, bath = liquid
    start = scene(build, f"{out}/start {liquid[0]}", liquid, FRAME)
    where, every = f"{out}/lammps {liquid[0]}", round(FRAME / dt)
    dump = f"dump frames all custom {every} frames.txt id xu yu zu\ndump_modify frames sort id"
    rows = lammps(start, where, pair, dt, round((MELT + length) / dt), every, f"{bath}\n{dump}")
    frames = []
    with open(f"{where}/frames.txt", encoding="utf-8") as text:
        while text.readline():
            for _ in range(8):
                text.readline()
            frames.append(np.fromstring(" ".join(text.readline() for _ in range(864)), sep=" ").reshape(864, 4)[:, 1:])
    first = round(MELT / FRAME)
    # LAMMPS takes three degrees of freedom off; in a bath of its own each particle has all.
    share = 1 if rule == "dpd" else 863 / 864
    return (blocked(rows[first:, 1] * share), blocked(rows[first:, 3]),
            diffusion(np.array(frames[first:]), np.full(3, 1e9), lags))


def main():
    build, out = sys.argv[1], sys.argv[2]
    jobs = int(sys.argv[3]) if len(sys.argv) > 3 else os.cpu_count()
    chosen = [liquid for liquid in LIQUIDS if len(sys.argv) < 5 or liquid[0] in sys.argv[4:]]
    work = [lambda liquid=liquid, side=side: side(build, out, liquid) for liquid in chosen for side in (ours, theirs)]
    results = in_parallel(jobs, work)
    with open(f"{out}/thermostats.dat", "w", encoding="utf-8") as table:
        for k, liquid in enumerate(chosen):
            for who, values in zip(("cuboct", "LAMMPS"), results[2 * k:2 * k + 2]):
                line = f"{liquid[0]}, {who}: " + "  ".join(f"{value:.5f} {error:.5f}" for value, error in values)
                print(line)
                print(line, file=table)
            off = [(a - b) / np.hypot(da, db) for (a, da), (b, db) in zip(*results[2 * k:2 * k + 2])]
            line = "off by, sigma: " + "  ".join(f"{value:+.1f}" for value in off)
            print(line)
            print(line, file=table)


if __name__ == "__main__":
    main()
