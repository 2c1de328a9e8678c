# SPDX-License-Identifier: MIT
"""Reads the frames of a torn coupon with VTK itself: positions and
types those of the trace, strains and broken bonds those that positions make. Ends with 77 where VTK is not installed.

usage: vtk_frames.py ROOT DIRECTORY_OF_CUBOCT
"""
import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import h5py
import numpy as np

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    print("no python3-vtk9")
    sys.exit(77)

ROOT, PROGRAMS = sys.argv[1:]
SCENE = os.path.join(ROOT, "scenes/coupon.toml")


def cuboct(*arguments):
    done = subprocess.run([os.path.join(PROGRAMS, "cuboct"), *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def read(path):
    """Points and point data by name."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    body = reader.GetOutput()
    assert body.GetNumberOfVerts() == body.GetNumberOfPoints(), "a point without its vertex is not drawn"
    data = body.GetPointData()
    arrays = {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}
    return vtk_to_numpy(body.GetPoints().GetData()), arrays


def bonds(x, reach):
    """Pairs (i, j), both ways, that are nearer than `reach`."""
    near = []
    for i in range(len(x)):
        far = np.linalg.norm(x - x[i], axis=1)
        near += [(i, j) for j in np.flatnonzero(far < reach) if j != i]
    return np.array(near)


def strains(x0, x, near):
    """Green-Lagrange tensors of the affine map that carries the first vectors to the neighbours into the present ones."""
    i, j = near.T
    before, now = x0[j] - x0[i], x[j] - x[i]
    both, one = np.zeros((len(x), 3, 3)), np.zeros((len(x), 3, 3))
    np.add.at(both, i, now[:, :, None] * before[:, None, :])
    np.add.at(one, i, before[:, :, None] * before[:, None, :])
    full = np.linalg.matrix_rank(one, tol=1e-6 * np.abs(one).max()) == 3
    f = np.zeros_like(both)
    f[full] = both[full] @ np.linalg.inv(one[full])
    return full, f, (np.transpose(f, (0, 2, 1)) @ f - np.eye(3)) / 2


facts = {name: entry["value"] for name, entry in json.loads(cuboct("check", SCENE, "--json")).items()}
with tempfile.TemporaryDirectory() as folder:
    cuboct("run", SCENE, "--frame-every", "4000", "--frames", "vtp", "--si", "--quiet", "--out", folder)
    listed = [entry.attrib for entry in xml.etree.ElementTree.parse(f"{folder}/frames.pvd").iter("DataSet")]
    frames = [read(os.path.join(folder, entry["file"])) for entry in listed]
    with h5py.File(f"{folder}/trace.h5") as trace:
        steps, first = trace["frames/step"][:], trace["frames/first"][:]
        x_si, v_si, types = trace["frames/x_si"][:], trace["frames/v_si"][:], trace["frames/type"][:]

assert len(frames) == len(steps) == 5, len(frames)
assert np.allclose([float(entry["timestep"]) for entry in listed], steps * facts["dt"], rtol=1e-8), listed
x0 = frames[0][0]
near = bonds(x0, (1 + 2**0.5) / 2 * facts["pitch"])
axis = np.eye(3)[0]  # of the scene's stress-strain probe
most = 0
for k, (x, data) in enumerate(frames):
    rows = slice(first[k], first[k + 1])
    assert set(data) == {"axial_strain", "strain", "broken_bonds", "velocity", "type_index", "id", "radius"}, set(data)
    assert x.dtype == np.float64 and np.abs(x - x_si[rows]).max() < 1e-12 * np.abs(x).max()
    assert np.abs(data["velocity"] - v_si[rows]).max() <= 1e-6 * np.abs(v_si[rows]).max()
    assert np.array_equal(data["type_index"], types[rows]) and len(set(data["type_index"])) > 1
    assert np.array_equal(data["id"], np.arange(len(x)))
    assert np.allclose(data["radius"], facts["pitch"] / 2, rtol=1e-6)
    full, f, tensor = strains(x0, x, near)
    assert full.sum() > 0.9 * len(x)
    mine = np.stack([tensor[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))], axis=1)
    scale = max(np.abs(mine[full]).max(), 1e-6)
    assert np.abs(data["strain"] - mine)[full].max() < 1e-5 * scale, f"strain of frame {k}"
    axial = np.linalg.norm(f @ axis, axis=1) - 1
    assert np.abs(data["axial_strain"] - axial)[full].max() < 1e-5 * scale, f"axial strain of frame {k}"
    gone = np.linalg.norm(x[near[:, 0]] - x[near[:, 1]], axis=1) > facts["cutoff"]
    assert np.array_equal(data["broken_bonds"], np.bincount(near[gone, 0], minlength=len(x))), f"bonds of frame {k}"
    most = max(most, int(data["broken_bonds"].max()))
assert most > 0, "nothing broke"
print(f"{len(frames)} frames of {len(x0)} particles; {most} bonds of one particle broken at most")
