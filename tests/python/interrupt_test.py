# SPDX-License-Identifier: MIT
"""Ctrl-C: KeyboardInterrupt after a whole step, and all goes on."""
import os
import signal
import unittest

from support import interrupt_after, main, scene_file

import cuboct

FOREVER = 10**9


class Interrupt(unittest.TestCase):
    def interrupted(self, call):
        interrupt = interrupt_after(0.3)
        with self.assertRaises(KeyboardInterrupt):
            call()
        interrupt.join()

    def test_stepping(self):
        for engine in ("golden", "lattice", "reference"):
            simulation = cuboct.Simulation(scene_file("lj_block.toml"), engine)
            self.interrupted(lambda: simulation.step(FOREVER))
            done = simulation.steps
            self.assertGreater(done, 0)
            simulation.step(2)
            self.assertEqual(simulation.steps, done + 2)
            if engine == "golden":
                golden = done
            if engine == "lattice":
                again = cuboct.Simulation(scene_file("lj_block.toml"))
                again.step(done + 2)
                self.assertEqual(again.hash, simulation.hash)
        self.assertGreater(golden, 0)

    def test_runs(self):
        scene = scene_file("lj_block.toml")
        self.interrupted(lambda: cuboct.run(scene, "golden", steps=10**6))
        self.interrupted(lambda: cuboct.crosscheck(scene, ["golden", "lattice"], steps=10**6))
        self.assertEqual(cuboct.run(scene, steps=2).steps, 2)

    def test_the_handler_of_before_is_back(self):
        heard = []
        before = signal.signal(signal.SIGINT, lambda *_: heard.append(1))
        try:
            cuboct.Simulation(scene_file("lj_block.toml")).step(5)
            os.kill(os.getpid(), signal.SIGINT)
            self.assertEqual(heard, [1])
        finally:
            signal.signal(signal.SIGINT, before)


main()
