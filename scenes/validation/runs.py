# SPDX-License-Identifier: MIT
"""Runs of cuboct and of LAMMPS that the scripts beside this file share. Needs python3-h5py (numpy comes with it)."""
import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


def cuboct(build, scene, out, changes=None, arch=None, engine="lattice"):
    """Runs a scene, by its path from this folder, with some `key = value` lines replaced. Returns the directory of the results.

    A key that stands in several lines is told apart by a comment: "uniform # everything".
    """
    os.makedirs(out, exist_ok=True)
    text = open(os.path.join(HERE, scene), encoding="utf-8").read()
    for key, value in (changes or {}).items():
        name, _, comment = key.partition(" # ")
        line = rf"(?m)^{name} = [^#\n]*(?=# {comment})" if comment else rf"(?m)^{name} = [^#\n]*"
        text, count = re.subn(line, lambda _, name=name, value=value: f"{name} = {value} ", text)
        if count != 1:
            raise SystemExit(f"{scene} has {count} lines '{key} = ...'")
    path = os.path.join(out, os.path.basename(scene))
    with open(path, "w", encoding="utf-8") as copy:
        copy.write(text)
    command = [os.path.join(build, "cuboct"), "run", path, "--engine", engine, "--out", os.path.join(out, "run")]
    if arch:
        command += ["--arch", os.path.join(HERE, arch)]
    if engine == "lattice":
        command += ["--threads", "1", "--hash-every", "1000000000"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return os.path.join(out, "run")


class Curves:
    """The curves of a run by name, and `step`."""

    def __init__(self, run):
        with h5py.File(os.path.join(run, "trace.h5")) as trace:
            self.values = {name: curve["value"][:] for name, curve in trace["curves"].items()}
            self.step = next(iter(trace["curves"].values()))["step"][:]

    def __getitem__(self, name):
        return self.values[name]


def first_frame(run):
    """Box, positions and velocities of step 0 from frames.xyz."""
    with open(os.path.join(run, "frames.xyz"), encoding="utf-8") as frames:
        count = int(frames.readline())
        box = [float(x) for x in re.search(r'Lattice="([^"]*)"', frames.readline()).group(1).split()]
        rows = np.array([frames.readline().split() for _ in range(count)])
    return np.array(box)[[0, 4, 8]], rows[:, 1:4].astype(float), rows[:, 8:11].astype(float)


def lammps(run, out, pair, dt, steps, every, more=""):
    """The same start in LAMMPS: an array of (step, kT, energy per particle, pressure). At constant energy, but for `more` lines."""
    os.makedirs(out, exist_ok=True)
    box, x, v = first_frame(run)
    with open(os.path.join(out, "start.data"), "w", encoding="utf-8") as data:
        data.write(f"\n\n{len(x)} atoms\n1 atom types\n")
        for axis in range(3):
            data.write(f"0 {box[axis]:.17g} {'xyz'[axis]}lo {'xyz'[axis]}hi\n")
        data.write("\nMasses\n\n1 1\n\nAtoms # atomic\n\n")
        data.writelines(f"{i + 1} 1 {a} {b} {c}\n" for i, (a, b, c) in enumerate(x))
        data.write("\nVelocities\n\n")
        data.writelines(f"{i + 1} {a} {b} {c}\n" for i, (a, b, c) in enumerate(v))
    with open(os.path.join(out, "in.lmp"), "w", encoding="utf-8") as text:
        text.write(f"""units lj
atom_style atomic
read_data start.data
{pair}
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {dt}
fix nve all nve
{more}
thermo_style custom step temp etotal press
thermo_modify norm yes format float %.15g
thermo {every}
run {steps}
""")
    done = subprocess.run([os.environ.get("LMP", "lmp"), "-in", "in.lmp", "-log", "none"], cwd=out, capture_output=True, text=True,
                          check=False, env={**os.environ, "OMP_NUM_THREADS": "1"})
    rows = re.findall(r"(?m)^ *(\d+) +(\S+) +(\S+) +(\S+) *$", done.stdout)
    if done.returncode != 0 or len(rows) < steps // every:
        raise SystemExit(done.stdout + done.stderr)
    return np.array(rows, dtype=float)


def in_parallel(jobs, work):
    """The results of a list of functions without arguments, in their order, on so many cores."""
    with ThreadPoolExecutor(jobs) as pool:
        return [future.result() for future in [pool.submit(one) for one in work]]


def blocked(samples):
    """Mean and its standard error, by blocks: H. Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91 (1989) 461.

    Neighbouring samples are averaged in pairs again and again. The error estimated as if samples were independent
    rises until blocks are longer than the correlation time, then stays. The first level that is within its own
    uncertainty, 1/sqrt(2 (n - 1)) of it, of the largest estimate at any later level with 16 blocks or more is taken.
    """
    x = np.asarray(samples, dtype=float)
    levels = []
    while len(x) >= 16:
        error = np.sqrt(x.var() / (len(x) - 1))
        levels.append((error, error / np.sqrt(2 * (len(x) - 1))))
        x = x[: len(x) // 2 * 2].reshape(-1, 2).mean(axis=1)
    for k, (error, doubt) in enumerate(levels):
        later = [e for e, _ in levels[k + 1 :]]
        if not later or max(later) <= error + doubt:
            return float(np.mean(samples)), error
    raise AssertionError("the last level always ends the search")
