# SPDX-License-Identifier: MIT
"""Measures of frames: against NumPy, and the command's numbers for the same run."""
import csv
import io
import os
import pickle
import subprocess
import tempfile
import unittest

import numpy as np
from support import PROGRAMS, main, scene_file

import cuboct


def columns(directory, what, *options):
    """What the command writes, by name, without units."""
    words = [os.path.join(PROGRAMS, "cuboct"), "measure", directory, what, *options]
    rows = list(csv.reader(io.StringIO(subprocess.run(words, check=True, capture_output=True, text=True).stdout)))
    return {name.split(" (")[0]: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}


class Measures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = cuboct.run(scene_file("lj_block.toml"), steps=40, frame_every=20)
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = os.path.join(cls.folder.name, "run")
        subprocess.run(
            [os.path.join(PROGRAMS, "cuboct"), "run", scene_file("lj_block.toml"), "--steps", "40", "--frame-every", "20", "--frames", "none",
             "--out", cls.out, "-q"],
            check=True, stdout=subprocess.DEVNULL,
        )  # fmt: skip

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_are_those_of_the_command(self):
        for what in ("rdf", "msd", "coordination", "cna", "stress"):
            wanted = columns(self.out, what)
            for found in (self.run_.measure(what), cuboct.measure(self.out, what)):
                self.assertEqual(list(found), list(wanted), what)
                for name, values in wanted.items():
                    self.assertEqual(found[name].tolist(), values, f"{what} {name}")
        few = self.run_.measure("msd", frames=[20, 40], com=True)
        self.assertEqual(few["step"].tolist(), [20, 40])
        self.assertEqual(few["msd"].tolist(), columns(self.out, "msd", "--frames", "20:", "--com")["msd"])
        self.assertEqual(few.units["msd"], "m^2")
        self.assertIn("frames", few.notes)
        self.assertEqual(len(self.run_.measure("cna", com=np.bool_(False), virial=0)["fcc"]), 3)
        found = {
            engine: cuboct.run(scene_file("rules/langevin.toml"), engine, steps=20, frame_every=20).measure("msd")["msd"][-1]
            for engine in ("golden", "reference")
        }
        self.assertAlmostEqual(found["golden"] / found["reference"], 1, delta=1e-3)

    def test_displacements_are_those_of_numpy(self):
        found = self.run_.measure("msd", particles=True)
        x = np.array([frame.positions for frame in self.run_.frames])
        moved = x - x[0]
        box = 2 * np.abs(moved).max()  # what went through a face jumps by the box's edge
        self.assertEqual(found.particles.shape, (3, 256, 3))
        inside = np.abs(moved) < box / 4
        self.assertGreater(inside.mean(), 0.9)
        np.testing.assert_allclose(found.particles[inside], moved[inside], atol=1e-12)
        np.testing.assert_allclose(found["msd"], (found.particles**2).sum(axis=2).mean(axis=1), rtol=1e-12)

    def test_each_particle_has_its_number(self):
        found = cuboct.measure(self.out, "cna", frames="all", cutoff=1.3, particles=True)
        self.assertEqual(found.particles.shape, (3, 256))
        self.assertEqual((found.particles == 1).sum(axis=1).tolist(), found["fcc"].tolist())
        stress = self.run_.measure("stress", volume=2.0, virial=True, particles=True)
        np.testing.assert_allclose(stress.particles.sum(axis=1)[:, 0] / 2, stress["xx"], rtol=1e-12)

    def test_what_is_wrong(self):
        for options, message in (
            ({"what": "rfd"}, "no measure 'rfd'"),
            ({"what": "cna", "com": True}, "com is not an option of cna"),
            ({"what": "rdf", "cutoff": -1.0}, "cutoff = -1: it is above 0"),
            ({"what": "rdf", "cutoff": "1 mm"}, "cutoff: '1 mm' is not a number: the scene has reduced units"),
            ({"what": "rdf", "bins": 0}, "bins = 0: 1 to 1000000"),
            ({"what": "cna", "frames": []}, "frames is an empty list: it names no step"),
            ({"what": "rdf", "particles": True}, "rdf has nothing of each particle"),
        ):
            with self.assertRaises(cuboct.InputError) as raised:
                self.run_.measure(**options)
            self.assertEqual(raised.exception.message, message)
        again = pickle.loads(pickle.dumps(self.run_))
        self.assertEqual(again.hash, self.run_.hash)
        with self.assertRaises(cuboct.InputError):
            again.measure("cna")


main()
