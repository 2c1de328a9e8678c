# SPDX-License-Identifier: MIT
"""What is wrong is told as an exception, with its place."""
import os
import shlex
import subprocess
import sys
import tempfile
import unittest

from support import main, scene_file

import cuboct


class Errors(unittest.TestCase):
    def refused(self, call, *arguments, **named):
        with self.assertRaises(cuboct.InputError) as caught:
            call(*arguments, **named)
        return caught.exception

    def test_a_place_in_a_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.toml")
            with open(scene_file("lj_block.toml"), encoding="utf-8") as file:
                text = file.read()
            with open(path, "w", encoding="utf-8") as file:
                file.write(text + "fram_every = 3\n")
            error = self.refused(cuboct.Simulation, path)
            line = text.count("\n") + 1
            self.assertEqual((error.file, error.line, error.column), (path, line, 1))
            self.assertEqual(error.message, "unknown key 'fram_every'")
            self.assertEqual(error.hint, "did you mean 'frame_every'?")
            self.assertIsNone(error.key)
            self.assertEqual(
                str(error),
                f"{path}:{line}:1: unknown key 'fram_every'\n"
                f"  {line} | fram_every = 3\n     | ^\n  hint: did you mean 'frame_every'?",
            )

    def test_a_key_of_a_dict(self):
        scene = cuboct.Scene.like("tension")
        scene["constraint"][1]["velocity"] = "[4, 0, 0] mm"
        for call in (scene.check, lambda: cuboct.Simulation(scene), lambda: cuboct.run(scene, "golden")):
            error = self.refused(call)
            self.assertEqual(error.key, "constraint[1].velocity")
            self.assertEqual(scene.toml().splitlines()[error.line - 1], 'velocity = "[4, 0, 0] mm"')
            self.assertTrue(str(error).startswith("scene, constraint[1].velocity: "), str(error))
        error = self.refused(cuboct.run, scene_file("lj_block.toml"), arch={"name": "small", "node": {"filter_lanes": 0}})
        self.assertEqual((error.file, error.key), ("arch", "node.filter_lanes"))

    def test_toml_that_is_none(self):
        error = self.refused(cuboct.Scene.parse, "a = \nb = 2\n")
        self.assertEqual((error.file, error.line), ("scene", 1))
        self.assertIn("cannot read this file", str(self.refused(cuboct.Scene.load, "/nowhere.toml")))

    def test_values_that_toml_has_not(self):
        error = self.refused(cuboct.Scene(run={"steps": None}).toml)
        self.assertIn("run.steps is of type NoneType", str(error))
        self.refused(cuboct.Scene({3: 4}).toml)
        self.refused(cuboct.Simulation, 17)

    def test_names(self):
        block = scene_file("lj_block.toml")
        self.assertEqual(str(self.refused(cuboct.Simulation, block, "latice")),
                         "unknown engine 'latice'\n  hint: did you mean 'lattice'?")  # fmt: skip
        error = self.refused(cuboct.Simulation, block, "gpu", precision="double")
        self.assertEqual(error.message, "the gpu engine in real numbers cannot be stepped")
        self.assertIn("cuboct.run", error.hint)
        self.assertEqual(self.refused(cuboct.Scene.like, "tensoin").hint, "did you mean 'tension'?")
        self.assertEqual(
            self.refused(cuboct.run, block, "reference", integrator="verlt").hint, "did you mean 'verlet'?"
        )
        self.assertEqual(self.refused(cuboct.Simulation(block).picture, "sped").hint, "did you mean 'speed'?")

    def test_numbers(self):
        block = scene_file("lj_block.toml")
        simulation = cuboct.Simulation(block)
        for wrong in (-1, 2.5, "3", True, None, 2**63):
            self.refused(simulation.step, wrong)
        self.refused(cuboct.run, block, steps=-1)
        self.refused(cuboct.run, block, threads=0)
        self.refused(cuboct.run, block, hash_every=0)
        self.refused(simulation.picture, limit=float("nan"))
        self.refused(simulation.picture, width=3)
        self.assertEqual(simulation.steps, 0)

    def test_engines_of_a_crosscheck(self):
        block = scene_file("lj_block.toml")
        for wrong in (["golden"], ["golden", "golden"], ["golden", "reference"], "golden"):
            self.refused(cuboct.crosscheck, block, wrong, steps=1)

    def test_a_program_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            cuboct.set_program_directory(folder)
            block = scene_file("lj_block.toml")
            simulation = cuboct.Simulation(block, "systemc")
            for call in (lambda: cuboct.run(block, "systemc", steps=1), lambda: simulation.step(1)):
                self.assertEqual(
                    self.refused(call).message,
                    "the systemc engine is not built: no program cuboct-systemc beside cuboct",
                )
            self.assertEqual(simulation.steps, 0)


class Faults(unittest.TestCase):
    """A lone particle that leaves the lattice."""

    scene = {
        "mass": "1 mg",
        "law": {"kind": "spline", "r": "[0, 1] mm", "force": "[1, 0] mN", "core": "0.5 mm"},
        "particle": [{"position": "[0, 0, 0] mm", "velocity": "[2, 1, 0.5] m/s"}],
        "run": {"dt": "10 us", "steps": 100000},
    }

    def test_a_step_that_cannot_be_done(self):
        ends = []
        for engine in ("golden", "lattice"):
            simulation = cuboct.Simulation(self.scene, engine, probe_every=0)
            with self.assertRaises(cuboct.RunError) as caught:
                simulation.run()
            error = caught.exception
            self.assertEqual(error.step, simulation.steps)
            self.assertGreater(error.step, 10)
            self.assertIn("left the lattice along x", str(error))
            self.assertIn("reach", error.advice)
            last = simulation.hash
            with self.assertRaises(cuboct.RunError):  # again, and again whole
                simulation.step()
            self.assertEqual(simulation.hash, last)
            with self.assertRaises(cuboct.RunError) as caught:
                cuboct.run(self.scene, engine)
            self.assertEqual(caught.exception.run.steps, simulation.steps)
            self.assertEqual(caught.exception.advice, error.advice)
            ends.append((error.step, last))
        self.assertEqual(*ends)


class Descriptors(unittest.TestCase):
    def test_closed_ones_are_no_file_of_ours(self):
        code = "import os, cuboct; assert all(os.path.samestat(os.fstat(k), os.stat('/dev/null')) for k in range(3))"
        command = f"exec {shlex.quote(sys.executable)} -c {shlex.quote(code)} <&- >&- 2>&-"
        self.assertEqual(subprocess.run(["bash", "-c", command], check=False).returncode, 0)


main()
