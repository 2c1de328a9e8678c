# SPDX-License-Identifier: MIT
"""Arrays as particles, by way of a file."""
import os
import tempfile
import unittest

import numpy as np

from support import command, main

import cuboct

LAW = {"kind": "lj", "epsilon": "0.0103 eV", "sigma": "3.4 angstrom", "cutoff": "5.5 angstrom"}
EDGE = 6 * 3.8e-10  # m


class Particles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.path = os.path.join(self.folder, "gas.xyz")
        random = np.random.default_rng(3)
        sites = np.stack(np.meshgrid(*[np.arange(6)] * 3), axis=-1).reshape(-1, 3) + 0.5
        self.x = 3.8e-10 * sites + random.normal(scale=1e-11, size=sites.shape)
        self.v = random.normal(scale=100, size=sites.shape)

    def scene(self, **more):
        tables = {"mass": "40 u", "particles": {"file": self.path}, "law": LAW, "run": {"dt": "2 fs", "steps": 20}}
        return cuboct.Scene(tables | more)

    def test_come_back_to_the_last_bit(self):
        cuboct.write_particles(self.path, self.x, self.v, box=[EDGE] * 3, species=["A", "B"] * (len(self.x) // 2))
        materials = [{"name": "B"}, {"name": "A", "mass": "20 u", "region": {"shape": "sphere", "radius": "1 m"}}]
        simulation = cuboct.Simulation(self.scene(material=materials), "reference")
        np.testing.assert_array_equal(simulation.positions, self.x)
        np.testing.assert_array_equal(simulation.velocities, self.v)
        self.assertEqual([simulation.type_names[k] for k in simulation.types[:3]], ["A", "B", "A"])
        simulation.run()
        self.assertGreater(np.abs(simulation.velocities - self.v).max(), 1)
        # What the command makes of a scene that was saved beside the file.
        saved = self.scene(material=materials)
        saved["particles"] = {"file": "gas.xyz"}
        saved.save(os.path.join(self.folder, "scene.toml"))
        golden = cuboct.run(os.path.join(self.folder, "scene.toml"), "golden")
        told = command("run", os.path.join(self.folder, "scene.toml"), "--engine", "golden", "--json")
        self.assertIn(golden.hash, told)
        # A scene that was loaded, and changed, finds the file too.
        changed = cuboct.Scene.load(os.path.join(self.folder, "scene.toml"))
        changed["run"]["steps"] = 10
        self.assertEqual(cuboct.run(changed, "lattice").hash, cuboct.run(changed, "golden").hash)

    def test_species_of_numpy(self):
        texts = []
        for species in (["A", "B"] * (len(self.x) // 2), np.array(["A", "B"] * (len(self.x) // 2))):
            cuboct.write_particles(self.path, self.x, species=species)
            with open(self.path, encoding="utf-8") as file:
                texts.append(file.read())
        self.assertEqual(texts[0], texts[1])

    def test_without_velocities_and_box(self):
        cuboct.write_particles(self.path, self.x / 3.4e-10, reduced=True)
        law = {"kind": "lj", "epsilon": 1, "sigma": 1, "cutoff": 1.6}
        simulation = cuboct.Simulation(
            {"units": "reduced", "mass": 1, "particles": {"file": self.path}, "law": law, "run": {"steps": 1}}, "reference"
        )
        np.testing.assert_array_equal(simulation.positions, self.x / 3.4e-10)
        self.assertFalse(simulation.velocities.any())

    def test_errors(self):
        for arguments, message in (
            (([1, 2, 3],), "positions have the shape (particles, 3), not (3,)"),
            (([["a", 2, 3]],), "positions are rows of three numbers"),
            (([[1, 2, np.nan]],), "positions hold a number that is not finite"),
            ((self.x, self.v[:5]), "216 positions, but 5 velocities"),
        ):
            with self.assertRaises(cuboct.InputError) as refused:
                cuboct.write_particles(self.path, *arguments)
            self.assertEqual(refused.exception.message, message)
        with self.assertRaises(cuboct.InputError) as refused:
            cuboct.write_particles(self.path, self.x, species="soft glue")
        self.assertEqual(refused.exception.message, "species are words without blanks, not 'soft glue'")
        for options, message in (
            ({"periodic": "XYZ"}, "periodic are axes of 'xyz', not 'XYZ'"),
            ({"box": [1, 0, 1]}, "a box has edges above 0, not [1.0, 0.0, 1.0]"),
        ):
            with self.assertRaises(cuboct.InputError) as refused:
                cuboct.write_particles(self.path, self.x, **{"box": [EDGE] * 3, **options})
            self.assertEqual(refused.exception.message, message)
        self.assertEqual(os.listdir(self.folder), [])
        with open(self.path, "w", encoding="utf-8") as file:
            file.write("1\n\nA 1 2 x\n")
        with self.assertRaises(cuboct.InputError) as refused:
            self.scene(particles={"file": self.path, "units": "si"}).check()
        error = refused.exception
        self.assertEqual((error.file, error.line, error.column), (self.path, 3, 7))
        self.assertEqual(error.message, "the z of a particle must be a number, not 'x'")
        with self.assertRaises(cuboct.InputError) as refused:
            self.scene(particles={"file": os.path.join(self.folder, "none")}).check()
        self.assertEqual(refused.exception.key, "particles.file")


main()
