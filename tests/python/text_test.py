# SPDX-License-Identifier: MIT
"""Rules that are text, stepped in integers: golden, lattice, and engines in programs of their own."""
import json
import os
import shutil
import tempfile
import unittest


from support import PROGRAMS, command, main, scene_file

import cuboct

HOST = os.path.join(PROGRAMS, "tests", "gpu", "cuboct-gpu-host")
ENGINES = ("golden", "lattice")


def text(name, **run):
    scene = cuboct.Scene.load(scene_file(f"rules/{name}.toml"))
    scene["run"].update(run)
    return scene


def pulled(**run):
    """The bar that yields, in its first stage: bonds remember."""
    scene = text("plastic", probe_every=5, **run)
    scene["constraint"][1]["velocity"] = "[20, 0, 0] m/s"
    del scene["stage"]
    return scene


def alike(test, a, b):
    """States, fields and curves to the last bit."""
    test.assertEqual(a.hash, b.hash)
    test.assertEqual(a.positions.tolist(), b.positions.tolist())
    test.assertEqual(a.velocities.tolist(), b.velocities.tolist())
    test.assertTrue(set(b.fields) <= set(a.fields))
    for name in b.fields:
        test.assertEqual(a.fields[name].tolist(), b.fields[name].tolist(), name)


class Steps(unittest.TestCase):
    def test_steps_are_one_run(self):
        for name, steps in (("heat", 30), ("glass", 6), ("copper", 6), ("langevin", 10)):
            scene = text(name, probe_every=2)
            hashes = set()
            for engine in ENGINES:
                whole = cuboct.run(scene, engine, steps=steps)
                simulation = cuboct.Simulation(scene, engine, probe_every=2)
                self.assertEqual(simulation.plan_hash, whole.plan_hash)
                simulation.step(steps // 2)
                half = simulation.fields
                simulation.step(steps - steps // 2)
                alike(self, simulation, whole)
                for key in whole.curves:
                    if key in simulation.curves and len(simulation.curves[key]) == len(whole.curves[key]):
                        self.assertEqual(simulation.curves[key].tolist(), whole.curves[key].tolist(), key)
                self.assertGreater(len(simulation.curves["energy.total"]), 2)
                hashes.add(simulation.hash)
                if name == "heat":
                    self.assertNotEqual(half["T"].tolist(), simulation.fields["T"].tolist())
            self.assertEqual(len(hashes), 1, name)

    def test_they_are_those_of_the_command(self):
        summary = json.loads(command("run", scene_file("rules/heat.toml"), "--engine", "golden", "--steps", "20", "--json"))
        simulation = cuboct.Simulation(scene_file("rules/heat.toml"), "lattice", rule_code="interpreted")
        simulation.step(20)
        self.assertEqual(simulation.hash, summary["state_hash"]["value"])
        self.assertAlmostEqual(simulation.fields["T"].mean(), 350, places=9)
        self.assertTrue(simulation.picture("speed").startswith(b"\x89PNG"))

    def test_frames_have_the_fields(self):
        run = cuboct.run(text("heat"), "golden", steps=10, frame_every=5)
        self.assertEqual([frame.fields["T"].shape for frame in run.frames], [(1280,)] * 3)
        self.assertEqual(run.frames[0].fields["T"].max(), 400)
        self.assertLess(run.fields["T"].max(), 400.0001)
        self.assertNotEqual(run.fields["T"].tolist(), run.frames[0].fields["T"].tolist())
        self.assertAlmostEqual(run.fields["T"].mean(), 350, places=9)

    def test_a_step_that_cannot_be_done(self):
        scene = pulled()  # so fast that a bond leaves its tables
        scene["constraint"][1]["velocity"] = "[400, 0, 0] m/s"
        with self.assertRaises(cuboct.RunError) as caught:
            cuboct.run(scene, "golden")
        whole = caught.exception
        self.assertGreater(whole.step, 0)
        for engine in ENGINES:
            simulation = cuboct.Simulation(scene, engine)
            for _ in range(2):
                with self.assertRaises(cuboct.RunError) as caught:
                    simulation.run()
                self.assertEqual((str(caught.exception), caught.exception.step), (str(whole), whole.step))
                self.assertEqual((simulation.steps, simulation.hash), (whole.step, whole.run.hash))


class Stages(unittest.TestCase):
    def test_one_begins_where_another_is(self):
        scene = text("plastic", steps=20)
        scene["stage"] = scene["stage"][:2]
        for stage, velocity in zip(scene["stage"], ("[20, 0, 0] m/s", "[-40, 0, 0] m/s")):
            stage["steps"] = 20
            stage["constraint"][0]["velocity"] = velocity
        run = cuboct.run(scene, "golden")
        self.assertEqual(list(run.stages), ["pull", "push"])
        for engine in ENGINES:
            first = cuboct.Simulation(scene, engine)
            first.run()
            alike(self, first, run.stages["pull"])
            second = cuboct.Simulation(scene, engine, stage="push", start=first)
            self.assertEqual(second.steps, 0)
            self.assertEqual(second.positions.tolist(), first.positions.tolist())
            second.run()
            alike(self, second, run)


class Changes(unittest.TestCase):
    def test_a_change_to_what_is_there_changes_no_bit(self):
        for engine in ENGINES:
            plain, changed = (cuboct.Simulation(pulled(), engine) for _ in range(2))
            plain.step(40)
            changed.step(25)
            changed.set_velocity("grip", [20, 0, 0])
            self.assertEqual(changed.steps, 25)
            changed.step(15)
            alike(self, changed, plain)

    def test_engines_stay_equal_and_bonds_remember(self):
        hashes = []
        for engine in ENGINES:
            simulation = cuboct.Simulation(pulled(), engine)
            simulation.step(30)
            stretched = simulation.energies["potential"]
            simulation.set_velocity("grip", [-20, 0, 0])
            simulation.step(30)
            hashes.append(simulation.hash)
            # Back at its length, a bar of springs would hold nothing.
            self.assertGreater(simulation.energies["potential"], 0.01 * stretched)
        self.assertEqual(*hashes)

    def test_noise_goes_on(self):
        """A change draws no number twice."""
        plain, changed = (cuboct.Simulation(text("langevin"), "golden", probe_every=0) for _ in range(2))
        plain.step(6)
        changed.step(3)
        changed.set_gravity([0, 0, 0])
        changed.step(3)
        alike(self, changed, plain)

    def test_refusals_change_nothing(self):
        simulation = cuboct.Simulation(pulled(), "golden")
        simulation.step(5)
        before = (simulation.hash, simulation.plan_hash)
        for wrong in ([1e9, 0, 0], [float("nan"), 0, 0]):
            with self.assertRaises(cuboct.InputError):
                simulation.set_velocity("grip", wrong)
        self.assertEqual((simulation.hash, simulation.plan_hash), before)
        simulation.step(5)


class Programs(unittest.TestCase):
    """Whole runs; none is stepped."""

    def test_ranks(self):
        if shutil.which("mpirun") is None:
            self.skipTest("no mpirun")
        scene = text("langevin")
        whole = cuboct.run(scene, "lattice", steps=5, ranks=2, rule_code="interpreted")
        self.assertEqual(whole.hash, cuboct.run(scene, "golden", steps=5).hash)

    def test_gpu(self):
        if not os.path.exists(HOST):
            self.skipTest("no kernels on the host")
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(os.path.abspath(HOST), os.path.join(folder, "cuboct-gpu"))
            os.symlink(os.path.abspath(os.path.join(PROGRAMS, "cuboct-read-trace")), os.path.join(folder, "cuboct-read-trace"))
            cuboct.set_program_directory(folder)
            try:
                here = cuboct.run(text("heat"), "golden", steps=5)
                there = cuboct.run(text("heat"), "gpu", steps=5, rule_code="interpreted")
                alike(self, there, here)
            finally:
                cuboct.set_program_directory(PROGRAMS)

    def test_none_is_stepped(self):
        for options, message in (
            ({"engine": "gpu"}, "a rule of text is not stepped in the gpu engine"),
            ({"engine": "lattice", "ranks": 2}, "a rule of text is not stepped in the lattice engine of several processes"),
        ):
            with self.assertRaises(cuboct.InputError) as caught:
                cuboct.Simulation(text("heat", steps=10), **options)
            self.assertEqual(caught.exception.message, message)
            self.assertEqual(caught.exception.key, "rule.file")


class Refusals(unittest.TestCase):
    def test_what_runs_no_text(self):
        for call in (
            lambda: cuboct.Simulation(text("heat", steps=10), "systemc"),
            lambda: cuboct.run(text("heat", steps=10), "rtl"),
        ):
            with self.assertRaises(cuboct.InputError) as caught:
                call()
            self.assertEqual(caught.exception.key, "rule.file")
            self.assertIn("reference, golden, lattice and gpu", caught.exception.hint)

    def test_how_its_code_runs(self):
        for call, message in (
            (lambda: cuboct.Simulation(text("heat"), "golden", rule_code="interpreted"),
             "--rule-code interpreted is an option of the lattice and the gpu engine, not of golden"),
            (lambda: cuboct.run(text("heat"), "gpu", rule_code="compiled"),
             "--rule-code compiled is an option of the lattice engine, not of gpu"),
            (lambda: cuboct.Simulation(scene_file("lj_block.toml"), "lattice", rule_code="compiled"),
             "--rule-code is of a [rule] of text with rounds of its own"),
            (lambda: cuboct.run(text("heat"), "lattice", rule_code="fast"), "unknown rule_code 'fast'"),
        ):  # fmt: skip
            with self.assertRaises(cuboct.InputError) as caught:
                call()
            self.assertEqual(caught.exception.message, message)


main()
