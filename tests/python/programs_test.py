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

from support import main, scene_file

import cuboct


class Programs(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(os.environ.pop, "LIE", None)
        for name in ("cuboct-systemc", "cuboct-rtl"):
            shutil.copy(sys.argv[3], os.path.join(self.folder.name, name))
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


main()
