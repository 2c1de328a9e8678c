# SPDX-License-Identifier: MIT
"""Speed of standing waves along [100]: docs/measured/validation.md, section 4.

    python3 scenes/validation/wave.py BUILD OUT [JOBS]

prints the table and writes OUT/wave.dat. Speeds are over sqrt(C11/density).
"""
import os
import sys

import numpy as np

from frequency import frequency, without_time_step
from runs import Curves, cuboct, in_parallel

CELLS = (10, 15, 25, 50, 100)
DT = 0.1414213562373095  # of the scene


def speed(build, out, name, cells, strain, **kind):
    length = cells * np.sqrt(2)
    crest = [length * part for part in (1 / 12, 5 / 12)]
    run = cuboct(build, "wave.toml", f"{out}/{name}_{cells}", {
        "cells": f"[{cells}, 3, 3]",
        "uniform # everything": f"[{-strain!r}, 0, 0]",
        "uniform # the left half": f"[{2 * strain!r}, 0, 0]",
        "left": f'{{ shape = "box", min = [0, -9, -9], max = [{length / 2!r}, 9, 9] }}',
        "crest": f'{{ shape = "box", min = [{crest[0]!r}, -9, -9], max = [{crest[1]!r}, 9, 9] }}',
        "duration": 16 * length,
        "probe_every": max(1, cells // 5)}, **kind)
    curves = Curves(run)
    w, _ = frequency(curves.step * DT, curves["crest.x"])
    return without_time_step(w, DT) * length / (2 * np.pi)


def main():
    build, out = sys.argv[1], sys.argv[2]
    jobs = int(sys.argv[3]) if len(sys.argv) > 3 else os.cpu_count()
    kinds = {"default_1e-3": {"strain": 1e-3, "arch": "default.toml"},
             "wide_1e-3": {"strain": 1e-3, "arch": "wide.toml"},
             "wide_1e-4": {"strain": 1e-4, "arch": "wide.toml"},
             "reference_1e-4": {"strain": 1e-4, "engine": "reference"}}
    work = [lambda cells=cells, name=name, kind=kind: speed(build, out, name, cells, **kind)
            for cells in CELLS for name, kind in kinds.items()]
    results = in_parallel(jobs, work)
    with open(f"{out}/wave.dat", "w", encoding="utf-8") as table:
        print("# cells " + " ".join(kinds) + " chain", file=table)
        for row, cells in enumerate(CELLS):
            # Planes half a cubic cell apart act on their neighbours alone: w = 2c/s sin(ks/2), ks/2 = pi/(2 cells).
            half = np.pi / (2 * cells)
            values = results[row * len(kinds) : (row + 1) * len(kinds)] + [np.sin(half) / half]
            line = f"{cells:4d} " + " ".join(f"{value:.6f}" for value in values)
            print(line)
            print(line, file=table)


if __name__ == "__main__":
    main()
