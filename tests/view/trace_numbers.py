#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the trace of a run holds, by h5py, for the test of its page to compare with.

usage: trace_numbers.py DIR [all] >FILE.json    all: of each particle"""
import json
import sys

import h5py
import numpy as np

IDS = 24 if "all" not in sys.argv[2:] else 10**9  # particles of each frame, spread over all


def some(count):
    return sorted({int(k) for k in np.linspace(0, count - 1, min(IDS, count))})


def fixed_frames(trace):
    head, frames, first = trace.attrs, trace["frames"], trace["frames/first"][:]
    edge = head["cell_edge"] * head.get("cell_shape", np.ones(3))
    unit = edge * 2.0 ** -(int(head["position_frac"]) + int(head["guard"]))
    cells = trace["lattice/cell"][:]
    for k, step in enumerate(frames["step"][:]):
        rows = slice(first[k], first[k + 1])
        x, v, cell = frames["x"][rows], frames["v"][rows], cells[frames["node"][rows]]
        place = head["origin"] + cell * edge + x * unit
        ids = some(len(x))
        yield {"step": int(step), "ids": ids, "x": place[ids].tolist(), "v": (v[ids] * unit / head["dt"]).tolist(),
               "words": [[str(word) for word in (*x[i], *v[i])] for i in ids], "cells": cell[ids].tolist(),
               "speed": np.linalg.norm(v * unit / head["dt"], axis=1).tolist(), "places": place.tolist(), "types": frames["type"][rows].tolist()}


def real_frames(trace):
    bodies = trace["bodies"]
    count = len(bodies["type"])
    for k, step in enumerate(bodies["step"][:]):
        x, v = bodies["x"][k * count:(k + 1) * count], bodies["v"][k * count:(k + 1) * count]
        ids = some(count)
        yield {"step": int(step), "ids": ids, "x": x[ids].tolist(), "v": v[ids].tolist(), "words": None, "cells": None,
               "speed": np.linalg.norm(v, axis=1).tolist(), "places": x.tolist(), "types": bodies["type"][:].tolist()}


def machine(trace):
    """Of a machine of one cell per node: its cells, what each held at the frames, first and last cycle of each phase of each step."""
    if "cycles" not in trace or trace.attrs["nodes"] != len(trace["lattice/cell"]):
        return None
    frames, first, cells = trace["frames"], trace["frames/first"][:], trace["lattice/cell"][:]
    held = [np.bincount(frames["node"][first[k]:first[k + 1]], minlength=len(cells)).tolist() for k in range(len(frames["step"]))]
    rounds = int(trace.attrs.get("rounds", 1))
    round_phases = ["exchange_x", "exchange_y", "exchange_z", "force", "update"]
    phases = [name if rounds == 1 else f"{name} {k + 1}" for k in range(rounds) for name in round_phases] + ["migrate_x", "migrate_y", "migrate_z"]
    return {"cells": cells.tolist(), "period": trace["lattice"].attrs["period"].tolist(), "held": held, "phases": phases, "cycles": trace["cycles"][:].tolist()}


with h5py.File(sys.argv[1] + "/trace.h5") as trace:
    real = "bodies" in trace and len(trace["bodies/step"]) > 0
    curves = {name: [curve["step"][:].tolist(), [value if np.isfinite(value) else None for value in curve["value"][:].tolist()]] for name, curve in trace["curves"].items()}
    print(json.dumps({"title": trace.attrs["title"].decode() if isinstance(trace.attrs["title"], bytes) else trace.attrs["title"],
                      "dt": float(trace.attrs["dt"]), "types": [name.decode() for name in trace["types"][:]],
                      "frames": list(real_frames(trace) if real else fixed_frames(trace)), "curves": curves,
                      "machine": None if real else machine(trace)}))
