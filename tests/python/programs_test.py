# SPDX-License-Identifier: MIT
"""Engines in programs of their own, by one that lies as told (tests/cli/fake_engine.cpp).

usage: programs_test.py ROOT DIRECTORY_OF_CUBOCT FAKE_ENGINE
"""
import os
import re
import shutil
import sys
import tempfile
import unittest

from support import interrupt_after, main, scene_file

import cuboct


class Programs(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(os.environ.pop, "LIE", None)
        for name in ("cuboct-systemc", "cuboct-rtl"):
            shutil.copy(sys.argv[3], os.path.join(self.folder.name, name))
        os.symlink(os.path.join(os.path.abspath(sys.argv[2]), "cuboct-read-trace"), os.path.join(self.folder.name, "cuboct-read-trace"))
        cuboct.set_program_directory(self.folder.name)
        self.scene = cuboct.Scene.load(scene_file("lj_block.toml"))
        self.scene["title"] = "changed in Python"  # so the program reads what was made here

    def test_a_run_in_a_program(self):
        run = cuboct.run(self.scene, "rtl", steps=5, frame_every=2)
        here = cuboct.run(self.scene, "golden", steps=5, frame_every=2)
        self.assertEqual(run.engine, "rtl")
        self.assertEqual(run.hashes.tolist(), here.hashes.tolist())
        self.assertEqual([frame.step for frame in run.frames], [0, 2, 4, 5])
        self.assertEqual(run.positions.tolist(), here.positions.tolist())
        for name in ("energy.total", "energy.kinetic"):
            self.assertEqual(run.curves[name].tolist(), here.curves[name].tolist())
        self.assertEqual(run.cycles.shape, (5, 27, 8, 2))

    def test_steps_of_a_program(self):
        golden = cuboct.Simulation(self.scene, "golden", probe_every=2)
        stepped = cuboct.Simulation(self.scene, "systemc", probe_every=2)
        for _ in range(3):
            golden.step(3)
            stepped.step(3)
            self.assertEqual((stepped.steps, stepped.hash), (golden.steps, golden.hash))
        self.assertEqual(stepped.positions.tolist(), golden.positions.tolist())
        self.assertEqual(stepped.curves["step"].tolist(), [0, 2, 4, 6, 8])
        for name in ("energy.total", "energy.kinetic"):
            self.assertEqual(stepped.curves[name].tolist(), golden.curves[name].tolist())
        with self.assertRaises(cuboct.InputError) as caught:
            stepped.set_gravity([0, 0, -1])
        self.assertIn("nothing of it can change on the way", str(caught.exception))

    def test_steps_that_fail(self):
        stepped = cuboct.Simulation(self.scene, "rtl", probe_every=0)
        stepped.step(2)
        os.environ["LIE"] = "crash"
        with self.assertRaisesRegex(RuntimeError, re.escape("cuboct-rtl was ended by signal 6 (Aborted)")):
            stepped.step(2)
        self.assertEqual(stepped.steps, 2)
        del os.environ["LIE"]
        stepped.step(1)
        self.assertEqual(stepped.hash, cuboct.run(self.scene, "golden", steps=3).hash)

    def test_a_particle_that_leaves(self):
        """The cells of a piece are those that can be reached from its start; a whole run's are those from the packing."""
        scene = {
            "mass": "1 mg",
            "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
            "particle": [{"position": "[0, 0, 0] mm", "velocity": "[2, 1, 0.5] m/s"}],
            "run": {"dt": "10 us", "steps": 100000},
        }
        with self.assertRaises(cuboct.RunError) as caught:
            cuboct.run(scene, "golden")
        whole = caught.exception
        stepped = cuboct.Simulation(scene, "systemc", probe_every=0)
        stepped.step(whole.step - 5)
        for _ in range(2):
            with self.assertRaises(cuboct.RunError) as caught:
                stepped.step(20)
            error = caught.exception
            self.assertEqual((error.step, str(error), error.advice), (whole.step, str(whole), whole.advice))
            self.assertEqual((stepped.steps, stepped.hash), (whole.step, whole.run.hash))

    def test_the_first_difference(self):
        os.environ["LIE"] = "state"
        found = cuboct.crosscheck(self.scene, ["golden", "rtl"], steps=5)
        self.assertFalse(found)
        self.assertEqual((found.step, found.engines), (3, ("golden", "rtl")))
        self.assertRegex(
            found.text,
            r"^mismatch: step 3, state hash: golden [0-9a-f]{16}, rtl [0-9a-f]{16}\n"
            r"first difference: step 3, cell \d+ \(\d \d \d\), particle 17, v\.y: golden -?\d+, rtl -?\d+$",
        )

    def test_what_a_program_refuses(self):
        os.environ["LIE"] = "refuse"
        with self.assertRaises(cuboct.InputError) as caught:
            cuboct.run(self.scene, "rtl", steps=5)
        self.assertEqual(str(caught.exception), "refused by the fake engine")
        os.environ["LIE"] = "crash"
        with self.assertRaisesRegex(RuntimeError, re.escape("cuboct-rtl was ended by signal 6 (Aborted)")):
            cuboct.run(self.scene, "rtl", steps=5)

    def test_a_stop_in_a_program(self):
        os.environ["LIE"] = "stop"
        with self.assertRaises(cuboct.RunError) as caught:
            cuboct.run(self.scene, "rtl", steps=5)
        self.assertIn("stopped by the fake engine", str(caught.exception))
        self.assertEqual(caught.exception.run.stopped, "stopped by the fake engine")


class Machine(unittest.TestCase):
    """The SystemC engine, whose lattice is that of the state with which a piece begins."""

    def setUp(self):
        if not os.path.exists(os.path.join(sys.argv[2], "cuboct-systemc")):
            self.skipTest("built without SystemC")
        cuboct.set_program_directory(sys.argv[2])

    def test_pieces_are_one_run(self):
        for name in ("lj_block.toml", "hot_cluster.toml"):
            scene = scene_file(name)
            stepped = cuboct.Simulation(scene, "systemc", probe_every=0)
            for _ in range(3):
                stepped.step(5)
            whole = cuboct.run(scene, "systemc", steps=15)
            self.assertEqual(stepped.hash, whole.hash, name)
            self.assertEqual(stepped.velocities.tolist(), whole.velocities.tolist(), name)

    def test_ctrl_c_ends_a_piece(self):
        scene = scene_file("lj_block.toml")
        stepped = cuboct.Simulation(scene, "systemc", probe_every=0)
        interrupt = interrupt_after(1)
        with self.assertRaises(KeyboardInterrupt):
            stepped.step(10**6)
        interrupt.join()
        self.assertGreater(stepped.steps, 0)
        stepped.step(2)
        golden = cuboct.Simulation(scene, "lattice", probe_every=0)
        golden.step(stepped.steps)
        self.assertEqual(stepped.hash, golden.hash)


main()
