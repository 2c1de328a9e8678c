# SPDX-License-Identifier: MIT
"""Starts scenes from files that other programs wrote: LAMMPS's write_data, ASE's extended XYZ and data files. Energies and a short run are
LAMMPS's own. A writer that is not installed is left out; ends with 77 where none is.

usage: particle_files.py DIRECTORY_OF_CUBOCT
"""
import csv
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np

try:
    import ase
    import ase.io
    import ase.units
except ImportError:
    ase = None
LAMMPS = shutil.which("lmp")
PROGRAMS = sys.argv[1]
EV, U = 1.602176634e-19, 1.66053906660e-27  # J, kg
# LAMMPS's eV is u (angstrom/ps)^2 by its constant mvv2e, of CODATA 2002 or so (update.cpp).
MVV2E = 1.0364269e-4
STEPS = 40

# By name of the units: lattice, mass, pair of LAMMPS, time step, and the scene's text.
LIQUIDS = {
    "lj": ("fcc 0.8442", 1.0, "1 1", 1.44, 0.004, 2.5, 'units = "reduced"\nmass = 1\n', "epsilon = 1\nsigma = 1\ncutoff = 2.5\n", "0.004", ""),
    "metal": (
        "fcc 5.4", 39.948, "0.0103 3.4", 250, 0.008, 8.5, 'mass = "39.948 u"\n',
        'epsilon = "0.0103 eV"\nsigma = "3.4 angstrom"\ncutoff = "8.5 angstrom"\n', '"8 fs"', 'units = "metal"\n',
    ),
}  # fmt: skip


def scene(folder, kind, file, more=""):
    _, _, _, _, _, _, head, law, dt, units = LIQUIDS[kind]
    path = os.path.join(folder, "scene.toml")
    with open(path, "w", encoding="utf-8") as out:
        out.write(f'{head}[particles]\nfile = "{file}"\n{more or units}[law]\nkind = "lj"\n{law}smooth = "linear"\n')
        out.write(f"[run]\ndt = {dt}\nsteps = {STEPS}\nenergy_every = 1\n")
    return path


def energies(folder, path, *words):
    """Of the start: potential and kinetic, in J or reduced."""
    out = os.path.join(folder, "run")
    command = [os.path.join(PROGRAMS, "cuboct"), "run", path, "--engine", "reference", "--integrator", "verlet", "--quiet", "--csv", "--force"]
    done = subprocess.run([*command, "--out", out, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    with open(os.path.join(out, "curves.csv"), encoding="utf-8") as file:
        first = next(csv.DictReader(file))
    value = {name.split(" ")[0]: float(number) for name, number in first.items() if number}
    return value["energy.potential"], value["energy.kinetic"]


def rows_of(path, first):
    with open(path, encoding="utf-8") as file:
        lines = [line.strip() for line in file]
    rows = np.array([line.split() for line in lines[lines.index(first) + 1 :]], dtype=float)
    return rows[np.argsort(rows[:, 0])]


def lammps_liquid(folder, kind):
    """Melts a crystal, writes it as data, and goes on: energies of the state that was written, and x, v at the end."""
    lattice, mass, pair, heat, dt, cutoff, *_ = LIQUIDS[kind]
    script = f"""units {kind}
lattice {lattice}
region box block -2 2 -2 2 -2 2
create_box 1 box
create_atoms 1 box
mass 1 {mass}
velocity all create {heat} 87287
pair_style lj/smooth/linear {cutoff}
pair_coeff 1 1 {pair} {cutoff}
fix 1 all nve
timestep {dt}
thermo_modify norm no
run 150
write_data {folder}/{kind}.data
run 0
print "energies $(pe:%.17g) $(ke:%.17g)"
run {STEPS}
write_dump all custom {folder}/{kind}.dump id x y z vx vy vz modify format float %.17g
"""
    done = subprocess.run([LAMMPS, "-log", "none", "-nocite"], input=script, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    told = next(line for line in done.stdout.splitlines() if line.startswith("energies "))
    return [float(word) for word in told.split()[1:]], rows_of(f"{folder}/{kind}.dump", "ITEM: ATOMS id x y z vx vy vz")


def last_state(folder):
    path = os.path.join(folder, "last.xyz")
    done = subprocess.run([os.path.join(PROGRAMS, "cuboct"), "state", os.path.join(folder, "run"), "--out", path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with open(path, encoding="utf-8") as file:
        count, head = int(file.readline()), file.readline()
        rows = np.array([[float(word) for word in line.split()[1:4] + line.split()[8:11]] for line in file])
    assert len(rows) == count
    edges = [float(word) for word in head.split('Lattice="')[1].split('"')[0].split()[::4]]
    return rows, np.array(edges)


def near(mine, its, relative, what):
    assert its != 0 and abs(mine / its - 1) < relative, f"{what}: {mine!r} here, {its!r} there"


def check_lammps(folder, kind):
    (potential, kinetic), end = lammps_liquid(folder, kind)
    # The two eV differ in their eighth digit, and the u: of positions as they are read nothing else does.
    unit = 1 if kind == "lj" else EV
    mine = energies(folder, scene(folder, kind, f"{kind}.data"))
    near(mine[0], potential * unit, 1e-12, f"potential energy of {kind}")
    near(mine[1], kinetic * unit, 1e-12 if kind == "lj" else 1e-7, f"kinetic energy of {kind}")
    # A short run: rounding, grown by chaos, and in metal units the two eV, for 40 steps of 0.004 tau or so.
    rows, edges = last_state(folder)
    length, speed = (1, 1) if kind == "lj" else (1e-10, 100)
    apart = rows[:, :3] / length - end[:, 1:4]
    apart -= edges / length * np.round(apart / (edges / length))
    size = 1 if kind == "lj" else 3.4
    tolerance = 1e-9 if kind == "lj" else 1e-6
    assert np.abs(apart).max() < tolerance * size, (kind, np.abs(apart).max())
    off = np.abs(rows[:, 3:] / speed - end[:, 4:]).max() / np.abs(end[:, 4:]).max()
    assert off < 10 * tolerance, (kind, off)
    moved = np.abs(rows[:, 3:] / speed - rows_of_velocities(f"{folder}/{kind}.data")).max() / np.abs(end[:, 4:]).max()
    assert moved > 0.01, "nothing moved"
    return potential * unit, kinetic * unit, len(rows)


def check_engines(folder):
    """All engines of integers that are built begin with the same bits."""
    path = scene(folder, "lj", "lj.data")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace("cutoff = 2.5", "cutoff = 1.6"))
    engines = ["golden", "lattice"] + [name for name in ("systemc",) if os.path.exists(os.path.join(PROGRAMS, "cuboct-" + name))]
    command = [os.path.join(PROGRAMS, "cuboct"), "crosscheck", path, "--engines", ",".join(engines), "--steps", "5"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"matched 1280 updates over 5 steps in {len(engines)} engines" in done.stdout, done.stdout


def rows_of_velocities(path):
    with open(path, encoding="utf-8") as file:
        text = file.read().split("Velocities")[1]
    rows = np.array([line.split() for line in text.split("\n") if line.strip()], dtype=float)
    return rows[np.argsort(rows[:, 0])][:, 1:4]


def check_ase(folder):
    """A crystal of argon that shakes. ASE's extended XYZ has 8 decimals of an angstrom, its data files all digits."""
    random = np.random.default_rng(7)
    count = 4
    base = 5.4 * np.array([[0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]])
    cells = 5.4 * np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), -1).reshape(-1, 1, 3)
    x = (cells + base).reshape(-1, 3) + random.normal(scale=0.15, size=(4 * count**3, 3))  # some are outside of the box
    atoms = ase.Atoms(f"Ar{len(x)}", positions=x, cell=[5.4 * count] * 3, pbc=True)
    atoms.set_momenta(random.normal(scale=3, size=x.shape))
    ase.io.write(f"{folder}/a.xyz", [atoms, atoms], format="extxyz")
    with open(f"{folder}/a.data", "w", encoding="utf-8") as out:
        ase.io.write(out, atoms, format="lammps-data", velocities=True, units="metal")
    d = x[:, None] - x[None]
    d -= 5.4 * count * np.round(d / (5.4 * count))
    r = np.sqrt((d**2).sum(-1))[np.triu_indices(len(x), 1)]
    r = r[r < 8.5]

    def lj(r):
        return 4 * 0.0103 * ((3.4 / r) ** 12 - (3.4 / r) ** 6)

    slope = -4 * 0.0103 * (12 * 3.4**12 / 8.5**13 - 6 * 3.4**6 / 8.5**7)
    potential = (lj(r) - lj(8.5) - slope * (r - 8.5)).sum() * EV
    kinetic = atoms.get_kinetic_energy() / ase.units.J
    # 5e-9 angstrom of each coordinate, times forces of some 0.1 eV/angstrom and the root of 768 coordinates, over 15 eV; ASE's
    # own constants are those of 2014.
    for file, units, digits in (("a.xyz", 'units = "ase"\n', 1e-8), ("a.data", 'units = "metal"\n', 1e-12)):
        mine = energies(folder, scene(folder, "metal", file, units), "--steps", "0")
        near(mine[0], potential, digits, f"potential energy of {file}")
        near(mine[1], kinetic, 1e-6, f"kinetic energy of {file}")


if ase is None and LAMMPS is None:
    print("neither python3-ase nor lammps")
    sys.exit(77)
with tempfile.TemporaryDirectory() as directory:
    if ase:
        check_ase(directory)
        print("files of ASE")
    if LAMMPS:
        for name in LIQUIDS:
            print(f"files of LAMMPS, units {name}: potential %.9g, kinetic %.9g of %d particles" % check_lammps(directory, name))
        check_engines(directory)
