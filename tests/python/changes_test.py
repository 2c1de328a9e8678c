# SPDX-License-Identifier: MIT
"""Constraints and gravity that change on the way."""
import unittest

import numpy as np

from support import main, scene_file

import cuboct


def bar():
    scene = cuboct.Scene.like("tension")
    scene["packing"]["pitch"] = "1.2 mm"
    scene["geometry"] = {"shape": "box", "size": "[24, 5, 5] mm"}
    return scene


class Changes(unittest.TestCase):
    def test_a_change_to_what_is_there_changes_no_bit(self):
        for engine in ("golden", "lattice"):
            plain, changed = (cuboct.Simulation(bar(), engine) for _ in range(2))
            plain.step(60)
            changed.step(23)
            changed.set_velocity("pulled", [4, 0, 0])
            self.assertEqual(changed.steps, 23)
            changed.step(37)
            self.assertEqual(changed.hash, plain.hash)
            self.assertEqual(changed.positions.tolist(), plain.positions.tolist())

    def test_engines_stay_equal_through_changes(self):
        hashes = []
        for engine in ("golden", "lattice"):
            simulation = cuboct.Simulation(bar(), engine)
            simulation.step(30)
            simulation.set_velocity("pulled", [-3, 0, 1])
            simulation.step(30)
            simulation.set_gravity([0, 0, -400])
            at = simulation.hash
            simulation.step(30)
            hashes.append((at, simulation.hash))
        self.assertEqual(*hashes)
        self.assertNotEqual(*hashes[0])

    def test_what_is_moved_goes_where_it_is_told(self):
        for engine in ("golden", "lattice", "reference"):
            simulation = cuboct.Simulation(bar(), engine)
            pulled = simulation.types == simulation.type_names.index("matter/pulled")
            self.assertGreater(pulled.sum(), 10)
            simulation.step(20)
            before = simulation.positions
            simulation.set_velocity("pulled", [0, 6, 0])
            np.testing.assert_array_equal(simulation.positions, before)
            simulation.step(50)
            way = (simulation.positions - before)[pulled]
            expected = np.array([0, 6 * 50 * simulation.dt, 0])
            # The fixed rule holds an imposed velocity to a thousandth.
            np.testing.assert_allclose(way, np.tile(expected, (len(way), 1)), rtol=1e-3, atol=1e-12)

    def test_free_fall(self):
        scene = {
            "mass": "1 mg",
            "gravity": "[0, 0, -1] m/s^2",
            "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
            "particle": [{"position": "[0, 0, 0] mm"}, {"position": "[5, 0, 3] mm"}],
            "run": {"dt": "10 us", "steps": 1000},
            "reach": {"margin": "3 mm"},
        }
        for engine in ("golden", "lattice", "reference"):
            simulation = cuboct.Simulation(scene, engine)
            simulation.step(100)
            speed = simulation.velocities[:, 2]
            simulation.set_gravity([0, 0, -10])
            simulation.step(100)
            # 100 steps of 10 us at 10 m/s^2.
            np.testing.assert_allclose(simulation.velocities[:, 2] - speed, -0.01, rtol=2e-3)

    def test_a_reach_that_follows_the_motion(self):
        scene = cuboct.Scene(
            {
                "units": "reduced",
                "mass": 1.0,
                "law": {"kind": "lj", "epsilon": 1.0, "sigma": 1.0, "cutoff": 2.5},
                "particle": [{"position": [0, 0, 0], "velocity": [0, 0, 3.0]}],
                "run": {"dt": 0.001, "steps": 5000},
                "reach": {"margin": "auto"},
            }
        )
        facts = scene.check()
        self.assertEqual(facts["reach"], "2.5 around each particle, a cell edge; of 'matter' +z 15 more, by the initial velocity")
        self.assertEqual((facts["cells_with_matter"], facts["warnings"]), (1, []))
        self.assertEqual(facts["cells"], 3 * 3 * 9)
        simulation = cuboct.Simulation(scene)
        simulation.run()
        np.testing.assert_allclose(simulation.positions, [[0, 0, 15]], atol=1e-3)
        scene["reach"] = {"margin": 60.0}
        self.assertIsNone(scene.check()["reach"])
        self.assertRegex(scene.check()["warnings"][0], 'asks for 81 of them: set margin = "auto", or margin = .2.5, 2.5, 18. for 135$')

    def test_a_box_that_no_cube_divides(self):
        scene = cuboct.Scene(
            {
                "units": "reduced",
                "mass": 1.0,
                "packing": {"pitch": 1.1},
                "law": {"kind": "lj", "epsilon": 1.0, "sigma": 1.0, "cutoff": 2.5},
                "box": {"cells": [6, 5, 8], "periodic": "xyz"},
                "velocity": [{"thermal_energy": 0.5, "seed": 1}],
                "run": {"dt": 0.004, "steps": 10},
            }
        )
        facts = scene.check()
        np.testing.assert_allclose(facts["cell_edges"], 1.1 * 2**0.5 * np.array([6 / 3, 5 / 3, 8 / 4]))
        self.assertEqual(facts["cell_edge"], max(facts["cell_edges"]))
        self.assertEqual(facts["cells"], 36)
        self.assertIsNone(facts["nodes"])
        golden, lattice = (cuboct.Simulation(scene, engine) for engine in ("golden", "lattice"))
        golden.run(), lattice.run()
        self.assertEqual(golden.hash, lattice.hash)
        self.assertGreater(np.abs(golden.positions - cuboct.Simulation(scene, "golden").positions).max(), 0.01)
        with self.assertRaisesRegex(cuboct.InputError, "no cell edge of at least 2.5 m divides the periodic box"):
            cuboct.Simulation(scene, "systemc")

    def test_beyond_the_cells_of_the_start(self):
        """Two particles, moved 1 mm along x, then 5 mm along y: five cells."""
        scene = {
            "mass": "1 mg",
            "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
            "particle": [{"position": "[0, 0, 0] mm"}, {"position": "[5, 0, 3] mm"}],
            "constraint": [
                {
                    "name": "all",
                    "kind": "moved",
                    "velocity": "[1, 0, 0] m/s",
                    "region": {"shape": "sphere", "radius": "1 m"},
                }
            ],
            "run": {"dt": "10 us", "steps": 100},
        }
        for engine in ("golden", "lattice"):
            simulation = cuboct.Simulation(scene, engine)
            self.assertAlmostEqual(cuboct.Scene(scene).check()["cell_edge"], 1e-3)
            start = simulation.positions
            simulation.run()
            cells = simulation.plan_hash
            simulation.set_velocity("all", [0, 5, 0])
            self.assertNotEqual(simulation.plan_hash, cells)
            simulation.step(100)
            np.testing.assert_allclose(simulation.positions - start, [[1e-3, 5e-3, 0]] * 2, rtol=1e-3, atol=1e-9)

    def test_refusals_change_nothing(self):
        simulation = cuboct.Simulation(bar())
        simulation.step(5)
        before = (simulation.hash, simulation.plan_hash)
        with self.assertRaises(cuboct.InputError) as caught:
            simulation.set_velocity("puled", [0, 0, 0])
        self.assertEqual(
            str(caught.exception), "no particle is held or moved by a constraint 'puled'\n  hint: did you mean 'pulled'?"
        )
        for wrong in ([1e9, 0, 0], [float("nan"), 0, 0], [1, 2], "4 m/s", None):
            with self.assertRaises(cuboct.InputError):
                simulation.set_velocity("pulled", wrong)
        self.assertEqual((simulation.hash, simulation.plan_hash), before)
        simulation.step(5)


main()
