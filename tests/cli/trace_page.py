# SPDX-License-Identifier: MIT
"""Runs the reader of docs/reference/trace.md, as it stands there, on traces that `cuboct run` keeps, and compares what it
reads with frames.xyz, frames/x_si and summary.json.

usage: trace_page.py ROOT DIRECTORY_OF_CUBOCT
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT, PROGRAMS = sys.argv[1:]


def reader():
    """The functions of the page's one block of Python."""
    page = open(os.path.join(ROOT, "docs/reference/trace.md"), encoding="utf-8").read()
    blocks = re.findall(r"(?ms)^```python\n(.*?)^```", page)
    assert len(blocks) == 1, f"{len(blocks)} blocks of Python"
    functions = {}
    exec(blocks[0], functions)
    return functions["read_frames"], functions["read_curve"]


def run(out, scene, *more):
    command = [os.path.join(PROGRAMS, "cuboct"), "run", os.path.join(ROOT, scene), "--out", out, *more]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def xyz_frames(path):
    """(time, ids, types as they stand there, positions, velocities) of each frame of an extended XYZ file."""
    with open(path, encoding="utf-8") as file:
        while count := file.readline():
            time = float(re.search(r" Time=(\S+)", file.readline()).group(1))
            rows = np.array([file.readline().split() for _ in range(int(count))])
            types = [f"{material}/{constraint}" if constraint != "-" else material for material, constraint in rows[:, 6:8]]
            yield time, rows[:, 4].astype(int), types, rows[:, 1:4].astype(float), rows[:, 8:11].astype(float)


def compare(read_frames, path, xyz):
    """Number of frames. frames.xyz has 9 digits of positions and times, 6 of velocities."""
    with h5py.File(path) as trace:
        x_si, v_si = trace["frames/x_si"][:], trace["frames/v_si"][:]
    at = frames = 0
    for mine, its in zip(read_frames(path), xyz_frames(xyz), strict=True):
        assert abs(mine[0] - its[0]) <= 1e-8 * its[0], "time"
        assert np.array_equal(mine[1], its[1]), "ids"
        assert [name.replace(" ", "_") for name in mine[2]] == its[2], "types"
        rows = slice(at, at + len(mine[1]))
        for name, a, b, si, digits in (("x", mine[3], its[3], x_si[rows], 1e-8), ("v", mine[4], its[4], v_si[rows], 1e-5)):
            size = np.abs(b).max()
            assert size > 0 or name == "v", name
            assert np.abs(a - b).max() <= digits * size, f"{name} of frames.xyz"
            assert np.abs(a - si).max() <= 1e-14 * max(size, np.abs(si).max()), f"{name} in SI"
        at, frames = rows.stop, frames + 1
    assert at == len(x_si)
    return frames


def compare_bodies(x, types, xyz):
    """Of a run in real numbers."""
    frames = list(xyz_frames(xyz))
    assert np.abs(x - np.concatenate([frame[3] for frame in frames])).max() <= 1e-8 * np.abs(x).max()
    assert list(types) == frames[0][2]
    return len(frames)


def goes_wrong(read_frames, out, attribute, value):
    """Whether the comparison tells a trace in which an attribute is another."""
    shutil.copy(out + "/trace.h5", out + "/changed.h5")
    with h5py.File(out + "/changed.h5", "r+") as trace:
        trace.attrs[attribute] = value(trace.attrs[attribute])
    try:
        compare(read_frames, out + "/changed.h5", out + "/frames.xyz")
    except AssertionError:
        return True
    return False


def compare_curves(read_curve, out):
    """Number of curves. The summary prints the last value of each that is no energy."""
    path = out + "/trace.h5"
    summary = json.load(open(out + "/summary.json", encoding="utf-8"))
    with h5py.File(path) as trace:
        names = list(trace["curves"])
        steps, dt, ended = trace.attrs["steps"], trace.attrs["dt"], trace.attrs["ended"].decode()
    assert ended == summary["ended"]["value"] == "finished", ended
    for name in names:
        time, value, unit = read_curve(path, name)
        assert abs(time[-1] - steps * dt) <= 1e-12 * steps * dt, name
        if name.startswith("energy."):
            continue
        item = summary[name]
        assert (item["value"], item.get("unit", "1")) == (value[-1], unit), name
        assert (item["smallest"], item["largest"]) == (value.min(), value.max()), name
    return len(names)


def main():
    read_frames, read_curve = reader()
    runs = [  # a body with types that are moved, a box that repeats, a flat sheet
        ("coupon", "lattice", ["--steps", "60", "--frame-every", "20"]),
        ("lj_block", "golden", ["--steps", "20", "--frame-every", "5"]),
        ("sheet", "lattice", ["--steps", "40", "--frame-every", "40"]),
    ]
    if os.access(os.path.join(PROGRAMS, "cuboct-systemc"), os.X_OK):
        runs.append(("lj_block", "systemc", ["--steps", "3"]))
    frames = curves = 0
    with tempfile.TemporaryDirectory() as work:
        for scene, engine, more in runs:
            out = run(f"{work}/{scene}.{engine}", f"scenes/{scene}.toml", "--engine", engine, "--si", *more)
            frames += compare(read_frames, out + "/trace.h5", out + "/frames.xyz")
            curves += compare_curves(read_curve, out)
            for attribute, value in (("position_frac", lambda p: p + 1), ("guard", lambda g: g + 1),
                                     ("cell_edge", lambda e: e * 1.001), ("origin", lambda o: o + 1e-3 * np.abs(o).max() + 1e-6),
                                     ("dt", lambda t: t * 1.001)):
                assert goes_wrong(read_frames, out, attribute, value), f"{scene}: a wrong {attribute} goes unseen"
        out = run(f"{work}/reference", "scenes/lj_block.toml", "--engine", "reference", "--steps", "5")
        compare_curves(read_curve, out)
        with h5py.File(out + "/trace.h5") as trace:
            assert "cell_edge" not in trace.attrs and trace.attrs["mass"] == 1
            x, types = trace["bodies/x"][:], trace["types"].asstr()[:][trace["bodies/type"][:]]
            frames += compare_bodies(x, types, out + "/frames.xyz")
            text = trace["source/scene"].asstr()[0]
            assert text == open(f"{ROOT}/scenes/lj_block.toml", encoding="utf-8").read()
    print(f"{frames} frames and {curves} curves")


main()
