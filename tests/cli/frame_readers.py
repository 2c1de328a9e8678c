# SPDX-License-Identifier: MIT
"""Reads the frames of `cuboct run` with the readers that they are meant for: ASE, LAMMPS's read_dump, VTK. Names and units are
those of the table in docs/reference/frames.md, values those of the trace. A reader that is not installed is left out; ends
with 77 where none is.

usage: frame_readers.py ROOT DIRECTORY_OF_CUBOCT
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

try:
    import ase.io
    import ase.units
except ImportError:
    ase = None
try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkDataArray
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    vtkXMLPolyDataReader = None
LAMMPS = shutil.which("lmp")

ROOT, PROGRAMS = sys.argv[1:]
U = 1.66053906660e-27  # kg

# A bar of copper and of something else, pulled.
BAR = """density = "8.96 g/cm^3"
geometry = { shape = "box", min = "[-3, -1, -1] nm", max = "[3, 1, 1] nm" }
[packing]
pitch = "0.5 nm"
[[material]]
name = "Cu"
[[material]]
name = "soft glue"
region = { shape = "half_space", point = "[1, 0, 0] nm", normal = "-x" }
density = "3 g/cm^3"
[law]
kind = "elastic"
youngs_modulus = "100 GPa"
direction = "x"
[[constraint]]
name = "left grip"
kind = "held"
region = { shape = "half_space", point = "[-2, 0, 0] nm", normal = "x" }
[[constraint]]
name = "right"
kind = "moved"
velocity = "[40, 0, 3] m/s"
region = { shape = "half_space", point = "[2, 0, 0] nm", normal = "-x" }
[run]
duration = "5 ps"
frame_every = 1000
"""
# A peridynamic block that tears.
GLASS = """density = "2440 kg/m^3"
packing = { pitch = "1 mm" }
geometry = { shape = "box", min = "[0, 0, 0] mm", max = "[6, 6, 3] mm" }
[[velocity]]
region = { shape = "half_space", point = "[0, 3.1, 0] mm", normal = "y" }
uniform = "[0, 3, 0] m/s"  # tears some bonds, and leaves some particles whole
[rule]
kind = "lps"
youngs_modulus = "72 GPa"
poissons_ratio = 0.22
fracture_energy = "3.8 J/m^2"
[run]
dt = "auto"
steps = 100
"""


def columns_of_page():
    """By format a dictionary of the names of the page's table and their units; and those of peridynamics alone."""
    page = open(os.path.join(ROOT, "docs/reference/frames.md"), encoding="utf-8").read()
    rows = [[cell.strip() for cell in row.strip("|").split("|")] for row in re.findall(r"(?m)^\|.*\|$", page.split("## Fields")[1])]
    head, rows = rows[0], rows[2:]
    rows = rows[: next((k for k, row in enumerate(rows) if len(row) != len(head)), len(rows))]
    formats, own = {cell.strip("`"): {} for cell in head[2:]}, set()
    for row in rows:
        for name, cell in zip(formats, row[2:]):
            unit = re.search(r" in (\S+)$", cell)
            for word in re.findall(r"`([^`]+)`", cell):
                formats[name][word] = unit.group(1) if unit else row[1]
                if "peridynamics" in row[0]:
                    own.add(word)
    assert all(len(names) >= 10 for names in formats.values()), formats
    return formats, own


PAGE, OWN = columns_of_page()


def expected(form, shown=()):
    return {name: unit for name, unit in PAGE[form].items() if name not in OWN or name in shown}


def run(folder, text, *more):
    """The summary, and of the last state positions and velocities in SI, and the types' names by particle."""
    scene = os.path.join(folder, "scene.toml")
    with open(scene, "w", encoding="utf-8") as file:
        file.write(text)
    command = [os.path.join(PROGRAMS, "cuboct"), "run", scene, "--frames", "xyz,ase,vtp,lammps", "--quiet", "--out", folder, *more]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    with open(f"{folder}/summary.json", encoding="utf-8") as file:
        summary = {name: entry["value"] for name, entry in json.load(file).items()}
    with h5py.File(f"{folder}/trace.h5") as trace:
        names = trace["types"].asstr()[:]
        if "bodies" in trace:
            bodies = trace["bodies"]
            return summary, bodies["x"][-len(bodies["type"]) :], bodies["v"][-len(bodies["type"]) :], names[bodies["type"][:]]
        rows = slice(int(trace["frames/first"][-2]), None)
        return summary, trace["frames/x_si"][rows], trace["frames/v_si"][rows], names[trace["frames/type"][rows]]


def near(mine, its, digits, what):
    scale = np.abs(its).max()
    assert scale > 0 and np.abs(mine - its).max() <= digits * scale, what


def check_ase(folder, x, v, types, shown):
    """The frame of frames.xyz, with what ASE makes of frames.ase.xyz held against it."""
    frames = ase.io.read(f"{folder}/frames.xyz", ":")
    si, angstrom = frames[-1], ase.io.read(f"{folder}/frames.ase.xyz")
    for form, atoms in (("xyz", si), ("ase", angstrom)):
        names = {"species", "pos"} | set(atoms.arrays) - {"numbers", "positions"}
        assert names == set(expected(form, shown)), (form, names ^ set(expected(form, shown)))
        units = dict(word.split(":") for word in atoms.info["units"].split())
        told = {name: unit for name, unit in expected(form, shown).items() if unit and name != "species"}
        assert {name: unit for name, unit in units.items() if name not in ("Time", "Lattice", "Origin")} == told, (form, units, told)
        assert units["Time"] == "s" and units["Lattice"] == units["pos"]
        assert np.array_equal(atoms.arrays["id"], np.arange(len(x)))
        words = [f"{m}/{c}" if c != "-" else m for m, c in zip(atoms.arrays["material"], atoms.arrays["constraint"])]
        assert words == [name.replace(" ", "_") for name in types]
        assert [symbol == "Cu" for symbol in atoms.symbols] == [name.split("/")[0] == "Cu" for name in types]
        assert set(atoms.symbols) <= {"Cu", "X"}
    near(si.positions, x, 1e-8, "positions")
    near(si.arrays["velo"], v, 1e-5, "velocities")
    near(angstrom.positions * 1e-10, x, 1e-8, "positions in angstrom")
    near(angstrom.cell.lengths() * 1e-10, si.cell.lengths(), 1e-8, "the cell in angstrom")
    near(angstrom.get_velocities() * ase.units.s / ase.units.m, v, 1e-5, "velocities by momenta")
    energy = ase.units.J * 0.5 * (angstrom.get_masses() * U * (v**2).sum(axis=1)).sum()
    assert abs(angstrom.get_kinetic_energy() / energy - 1) < 1e-4
    return si, len(frames)


def check_vtk(folder, x, v, types, shown, si):
    reader = vtkXMLPolyDataReader()
    last = sorted(name for name in os.listdir(folder) if name.endswith(".vtp"))[-1]
    reader.SetFileName(os.path.join(folder, last))
    reader.Update()
    body = reader.GetOutput()
    arrays = [body.GetPointData().GetArray(k) for k in range(body.GetPointData().GetNumberOfArrays())] + [body.GetPoints().GetData()]
    names = [array.GetName() for array in arrays]
    strings = {name: body.GetFieldData().GetAbstractArray(name) for name in ("material", "constraint")}
    assert set(names) | set(strings) == set(expected("vtp", shown)), names
    units = {}
    for array in arrays:
        information = array.GetInformation() if array.HasInformation() else None
        units[array.GetName()] = (information.Get(vtkDataArray.UNITS_LABEL()) if information else None) or ""
    assert units == {name: unit for name, unit in expected("vtp", shown).items() if name not in strings}, units
    data = dict(zip(names, map(vtk_to_numpy, arrays)))
    near(data["position"], x, 1e-12, "positions of VTK")
    near(data["velocity"], v, 1e-6, "velocities of VTK")
    index = data["type_index"]
    words = [[array.GetValue(k) for k in index] for array in strings.values()]
    assert [f"{m}/{c}" if c else m for m, c in zip(*words)] == list(types)
    assert body.GetNumberOfVerts() == len(x), "a point without its vertex is not drawn"
    if si is not None:  # one name has one value in all formats
        tensor = body.GetPointData().GetArray("strain")
        order = ["xx", "yy", "zz", "xy", "xz", "yz"]
        places = [order.index(tensor.GetComponentName(k)) for k in range(6)]
        assert places == [0, 1, 2, 3, 5, 4]
        near(data["strain"], si.arrays["strain"][:, places], 1e-5, "strains of VTK")
        for name in ("axial_strain", "radius", "broken_bonds", "id", "type_index", *shown):
            assert np.allclose(data[name], si.arrays[name], rtol=1e-5, atol=1e-5 * np.abs(si.arrays[name]).max()), name


def check_lammps(folder, x, v, types, shown, si):
    """read_dump takes the last frame in, write_dump puts it out. One more column is read as a charge."""
    column = "damage" if "damage" in shown else "axial_strain"
    count = len(set(types))
    with h5py.File(f"{folder}/trace.h5") as trace:
        step = int(trace["bodies/step" if "bodies" in trace else "frames/step"][-1])
    script = f"""units si
atom_style charge
boundary f f f
region all block 0 1 0 1 0 1
create_box {count} all
mass * 1
read_dump {folder}/frames.dump.gz {step} x y z vx vy vz q label q {column} box yes replace no purge yes add keep
write_dump all custom {folder}/again.dump id type x y z vx vy vz q modify sort id format float %.17g
"""
    done = subprocess.run([LAMMPS, "-log", "none", "-nocite"], input=script, capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    with open(f"{folder}/again.dump", encoding="utf-8") as file:
        rows = np.array([line.split() for line in file.read().split("ITEM: ATOMS")[1].splitlines()[1:]], dtype=float)
    assert np.array_equal(rows[:, 0], 1 + np.arange(len(x))), "ids"
    assert len({(name, kind) for name, kind in zip(types, rows[:, 1])}) == count == len(set(rows[:, 1])), "types"
    near(rows[:, 2:5], x, 1e-8, "positions of LAMMPS")
    near(rows[:, 5:8], v, 1e-5, "velocities of LAMMPS")
    if si is not None:
        near(rows[:, 8], si.arrays[column], 1e-5, f"{column} of LAMMPS")
    dump = subprocess.run(["gzip", "-dc", f"{folder}/frames.dump.gz"], capture_output=True, text=True, check=True).stdout
    names = dump.split("ITEM: ATOMS ")[1].split("\n")[0].split()
    assert set(names) == set(expected("lammps", shown)), names
    assert dump.startswith("ITEM: UNITS\nsi\n")


def check(text, shown, *more):
    with tempfile.TemporaryDirectory() as folder:
        summary, x, v, types = run(folder, text, *more)
        si, frames = check_ase(folder, x, v, types, shown) if ase else (None, 0)
        if vtkXMLPolyDataReader:
            check_vtk(folder, x, v, types, shown, si)
        if LAMMPS:
            check_lammps(folder, x, v, types, shown, si)
        return summary, si, frames


readers = [name for name, there in (("ASE", ase), ("LAMMPS", LAMMPS), ("VTK", vtkXMLPolyDataReader)) if there]
if not readers:
    print("neither python3-ase nor lammps nor python3-vtk9")
    sys.exit(77)
_, bar, count = check(BAR, (), "--si")
assert bar is None or (count > 1 and len(set(bar.arrays["type_index"])) > 2)
summary, glass, _ = check(GLASS, ("dilatation", "damage"))
if glass is not None:
    damage = glass.arrays["damage"]
    assert 0 < summary["mean_damage"] < summary["largest_damage"]
    assert abs(damage.mean() / summary["mean_damage"] - 1) < 1e-5 and abs(damage.max() / summary["largest_damage"] - 1) < 1e-5
    # Where nothing is gone, the volume's growth is the trace of the strain, to its first order.
    whole = damage == 0
    trace = glass.arrays["strain"][whole][:, :3].sum(axis=1)
    assert whole.sum() > 20 and np.corrcoef(glass.arrays["dilatation"][whole], trace)[0, 1] > 0.9
print(f"read by {', '.join(readers)}")
