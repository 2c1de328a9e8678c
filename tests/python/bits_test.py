# SPDX-License-Identifier: MIT
"""Python's runs are those of the command, bit by bit."""
import json
import os
import unittest

from support import PROGRAMS, command, main, scene_file

import cuboct

STEPS = 60


class Bits(unittest.TestCase):
    def test_hashes_are_those_of_the_command(self):
        compared = 0
        for scene in ("lj_block.toml", "two_types.toml"):
            hashes = set()
            for engine in ("golden", "lattice"):
                summary = json.loads(
                    command("run", scene_file(scene), "--engine", engine, "--steps", str(STEPS), "--json")
                )
                simulation = cuboct.Simulation(scene_file(scene), engine)
                first = simulation.hash
                simulation.step(STEPS)
                self.assertEqual(simulation.hash, summary["state_hash"]["value"])
                self.assertEqual(simulation.plan_hash, summary["plan_hash"]["value"])
                self.assertNotEqual(simulation.hash, first)
                run = cuboct.run(scene_file(scene), engine, steps=STEPS)
                self.assertEqual(run.hash, simulation.hash)
                self.assertEqual(run.summary["energy"], summary["energy"])
                self.assertEqual(run.positions.tolist(), simulation.positions.tolist())
                hashes.add(run.hash)
                compared += 1
            self.assertEqual(len(hashes), 1)
        self.assertEqual(compared, 4)

    def test_a_scene_that_python_wrote_is_the_same(self):
        read = cuboct.Scene.load(scene_file("two_types.toml"))
        written = cuboct.Scene(read)
        self.assertNotEqual(written.toml(), read.toml())
        self.assertEqual(written.check(), read.check())
        runs = [cuboct.run(scene, "golden", steps=3) for scene in (read, written)]
        self.assertEqual(runs[0].hash, runs[1].hash)

    def test_crosscheck(self):
        found = cuboct.crosscheck(scene_file("lj_block.toml"), ["golden", "lattice"], steps=5)
        self.assertTrue(found)
        self.assertEqual(str(found), "matched 1280 updates over 5 steps in 2 engines")
        self.assertEqual((found.updates, found.steps, found.step, found.engines), (1280, 5, None, None))

    @unittest.skipUnless(os.path.exists(os.path.join(PROGRAMS, "cuboct-systemc")), "no cuboct-systemc")
    def test_an_engine_in_a_program_of_its_own(self):
        scene = cuboct.Scene.load(scene_file("lj_block.toml"))
        here = cuboct.run(scene, "lattice", steps=5, cycles=True, frame_every=1)
        there = cuboct.run(scene, "systemc", steps=5, frame_every=1)
        self.assertEqual(here.hash, there.hash)
        self.assertEqual(here.cycles.shape, (5, here.summary["nodes"]["value"], 8, 2))
        self.assertTrue((here.cycles == there.cycles).all())
        self.assertEqual([frame.step for frame in there.frames], [0, 1, 2, 3, 4, 5])
        for a, b in zip(here.frames, there.frames):
            self.assertTrue((a.positions == b.positions).all() and (a.velocities == b.velocities).all())
        self.assertTrue(cuboct.crosscheck(scene, ["golden", "systemc"], steps=5))


main()
