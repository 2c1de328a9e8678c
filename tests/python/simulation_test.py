# SPDX-License-Identifier: MIT
"""Arrays, energies, curves and pictures against each other and against the command's."""
import struct
import threading
import time
import unittest

import numpy as np

from support import main, scene_file

import cuboct


class State(unittest.TestCase):
    def test_arrays_are_copies_in_si(self):
        # One particle at rest, another that flies: 100 steps of 1 us at 2 m/s are 0.2 mm.
        scene = {
            "mass": "1 mg",
            "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
            "particle": [
                {"position": "[0, 0, 0] mm"},
                {"position": "[5, 0, 0] mm", "velocity": "[0, 2, 0] m/s"},
            ],
            "run": {"dt": "1 us", "steps": 100},
            "reach": {"margin": "3 mm"},
        }
        for engine in ("golden", "lattice", "reference"):
            simulation = cuboct.Simulation(scene, engine)
            before = simulation.positions
            self.assertEqual(before.shape, (2, 3))
            simulation.step(40)
            simulation.run()  # what is left
            self.assertEqual((simulation.steps, simulation.dt), (100, 1e-6))
            self.assertAlmostEqual(simulation.time, 1e-4, places=12)
            # The fixed rule keeps some 20 bits of a millimetre.
            np.testing.assert_allclose(
                simulation.positions - before, [[0, 0, 0], [0, 2e-4, 0]], rtol=0, atol=2e-9, err_msg=engine
            )
            np.testing.assert_allclose(simulation.velocities, [[0, 0, 0], [0, 2, 0]], atol=1e-3)
            # 1 mg at 2 m/s: m v^2/2 = 2e-6 J.
            self.assertAlmostEqual(simulation.energies["kinetic"] / 2e-6, 1, places=3)
            before[0, 0] = 1  # ours alone
            self.assertLess(simulation.positions[0, 0], 1e-3)
            self.assertEqual(simulation.types.tolist(), [0, 0])
            self.assertEqual(simulation.type_names, ["matter"])
            np.testing.assert_allclose(simulation.masses, [1e-6, 1e-6])

    def test_materials_have_their_masses(self):
        everywhere = {"shape": "half_space", "point": "[1, 0, 0] mm", "normal": "-x"}
        scene = {
            "mass": "1 mg",
            "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
            "material": [{"name": "light"}, {"name": "heavy", "mass": "4 mg", "region": everywhere}],
            "particle": [
                {"position": "[0, 0, 0] mm", "velocity": "[0, 1, 0] m/s"},
                {"position": "[5, 0, 0] mm", "velocity": "[0, 2, 0] m/s"},
            ],
            "run": {"dt": "1 us", "steps": 10},
            "reach": {"margin": "3 mm"},
        }
        for engine in ("golden", "lattice", "reference"):
            simulation = cuboct.Simulation(scene, engine)
            simulation.run()
            np.testing.assert_allclose(simulation.masses, [1e-6, 4e-6])
            kinetic = (simulation.masses * (simulation.velocities**2).sum(axis=1)).sum() / 2
            self.assertAlmostEqual(simulation.energies["kinetic"] / kinetic, 1, places=6)

    def test_energies_are_the_sum(self):
        simulation = cuboct.Simulation(scene_file("lj_block.toml"))
        simulation.step(10)
        energies = simulation.energies
        self.assertEqual(set(energies), {"kinetic", "potential", "gravity", "total"})
        self.assertLess(energies["potential"], 0)
        self.assertAlmostEqual(
            energies["total"], energies["kinetic"] + energies["potential"] + energies["gravity"]
        )
        # 2 K/(g k_B), k_B = 1 in reduced units, g = 3 N - 3.
        self.assertAlmostEqual(
            simulation.temperature, 2 * energies["kinetic"] / (3 * simulation.particles - 3), places=6
        )

    def test_curves_are_those_of_a_run(self):
        scene = cuboct.Scene.load(scene_file("coupon.toml"))
        scene["run"]["probe_every"] = 20
        scene["run"]["energy_every"] = 100
        run = cuboct.run(scene, steps=100)
        simulation = cuboct.Simulation(scene)
        for _ in range(4):
            simulation.step(25)
        self.assertEqual(run.curves["step"].tolist(), [0, 20, 40, 60, 80, 100])
        self.assertEqual(set(run.curves), set(simulation.curves))
        self.assertGreater(len(run.curves), 6)
        for name, values in run.curves.items():
            self.assertEqual(simulation.curves[name].tolist(), values.tolist(), name)
        self.assertEqual(run.units, simulation.units)
        self.assertEqual(run.units["energy.total"], "J")
        self.assertEqual(len(cuboct.Simulation(scene, probe_every=0).curves["step"]), 0)

    def test_reference_has_no_hash(self):
        simulation = cuboct.Simulation(scene_file("lj_block.toml"), "reference", integrator="verlet")
        simulation.step(3)
        self.assertIsNone(simulation.hash)
        self.assertIsNone(cuboct.run(scene_file("lj_block.toml"), "reference", steps=3).hash)

    def test_picture(self):
        simulation = cuboct.Simulation(scene_file("coupon.toml"))
        simulation.step(20)
        for png in (simulation.picture("speed", width=640), simulation._repr_png_()):
            self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", simulation.picture(width=640)[16:24])
        self.assertEqual(width, 640)
        self.assertGreater(height, 100)

    def test_other_threads_run_meanwhile(self):
        simulation = cuboct.Simulation(scene_file("coupon.toml"), "golden", probe_every=0)
        steps, counted = 20, 0
        # Held out, no length of the call would let this thread count.
        while counted < 5 and steps < 10_000:
            steps, counted = 2 * steps, 0
            before, began, done = simulation.steps, threading.Event(), threading.Event()

            def step():
                began.set()
                simulation.step(steps)
                done.set()

            thread = threading.Thread(target=step)
            thread.start()
            began.wait()
            while not done.is_set():
                counted += 1
                time.sleep(0.001)
            thread.join()
            self.assertEqual(simulation.steps, before + steps)
        self.assertGreaterEqual(counted, 5)

    def test_two_threads_share_one(self):
        alone = cuboct.Simulation(scene_file("lj_block.toml"))
        alone.step(80)
        shared = cuboct.Simulation(scene_file("lj_block.toml"))
        threads = [threading.Thread(target=shared.step, args=(20,)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((shared.steps, shared.hash), (80, alone.hash))


main()
