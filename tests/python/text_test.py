# SPDX-License-Identifier: MIT
"""Rules that are text, stepped in integers: golden, lattice, and engines in programs of their own."""
import contextlib
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
    def test_curves_as_a_table(self):
        run = cuboct.run(scene_file("rules/heat.toml"), steps=6)
        table = run.table()
        self.assertEqual(table["step"].tolist(), [0, 2, 4, 6])
        self.assertEqual(table["time"].tolist(), run.curves["time"].tolist())
        self.assertEqual(table["left.T"].tolist(), run.curves["left.T"].tolist())
        # Energies have two samples, of the first and of the last step.
        self.assertEqual(run.curves["energy.step"].tolist(), [0, 6])
        self.assertEqual([value != value for value in table["energy.total"]], [False, True, True, False])
        self.assertNotIn("energy.step", table)

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


@contextlib.contextmanager
def gpu_on_the_host(test):
    """The gpu engine's program with loops for kernels."""
    if not os.path.exists(HOST):
        test.skipTest("no kernels on the host")
    with tempfile.TemporaryDirectory() as folder:
        for program, name in ((HOST, "cuboct-gpu"), (os.path.join(PROGRAMS, "cuboct-read-trace"), "cuboct-read-trace")):
            os.symlink(os.path.abspath(program), os.path.join(folder, name))
        cuboct.set_program_directory(folder)
        try:
            yield
        finally:
            cuboct.set_program_directory(PROGRAMS)


class Programs(unittest.TestCase):
    def steps(self, scene, engine, steps, **options):
        """In parts of the program, and as golden takes them here."""
        here = cuboct.Simulation(scene, "golden", probe_every=3)
        there = cuboct.Simulation(scene, engine, probe_every=3, rule_code="interpreted", **options)
        for part in steps:
            here.step(part)
            there.step(part)
            alike(self, there, here)
            self.assertEqual(there.steps, here.steps)
        self.assertEqual(set(there.curves), set(here.curves))
        for key in here.curves:
            self.assertEqual(there.curves[key].tolist(), here.curves[key].tolist(), key)
        return there

    def test_ranks(self):
        if shutil.which("mpirun") is None:
            self.skipTest("no mpirun")
        scene = text("langevin")
        whole = cuboct.run(scene, "lattice", steps=5, ranks=2, rule_code="interpreted")
        self.assertEqual(whole.hash, cuboct.run(scene, "golden", steps=5).hash)
        self.steps(scene, "lattice", (2, 3), ranks=2)

    def test_gpu(self):
        with gpu_on_the_host(self):
            here = cuboct.run(text("heat"), "golden", steps=5)
            there = cuboct.run(text("heat"), "gpu", steps=5, rule_code="interpreted")
            alike(self, there, here)

    def test_gpu_is_stepped(self):
        with gpu_on_the_host(self):
            for name in ("heat", "langevin", "copper"):
                simulation = self.steps(text(name), "gpu", (2, 4, 1))
                if name == "heat":
                    self.assertGreater(simulation.fields["T"].max(), 300)
            self.steps(pulled(), "gpu", (3, 4))
            with self.assertRaises(cuboct.InputError) as caught:
                simulation.set_gravity([0, 0, 1])
            self.assertIn("is a program that reads the scene", caught.exception.message)

    def test_damage(self):
        torn = text("glass")
        for constraint, speed in zip(torn["constraint"], (400, -400)):
            constraint["velocity"] = f"[0, {speed}, 0] m/s"
        del torn["rule"]["start"]["hard"]
        with gpu_on_the_host(self):
            simulation = self.steps(torn, "gpu", (4, 3))
            whole = cuboct.run(torn, "gpu", steps=7, rule_code="interpreted")
        self.assertGreater(simulation.fields["damage"].max(), 0.2)
        self.assertEqual(whole.fields["damage"].tolist(), simulation.fields["damage"].tolist())

    def test_a_fault_is_that_of_the_run(self):
        scene = text("langevin", dt=0.02, steps=40)
        scene["velocity"][0]["thermal_energy"] = 400.0
        with self.assertRaises(cuboct.RunError) as here:
            cuboct.Simulation(scene, "golden", probe_every=0).run()
        with gpu_on_the_host(self), self.assertRaises(cuboct.RunError) as there:
            cuboct.Simulation(scene, "gpu", probe_every=0, rule_code="interpreted").run()
        self.assertEqual(str(there.exception), str(here.exception))

    def test_where_there_is_no_gpu(self):
        for precision in ("fixed", "float"):
            with tempfile.TemporaryDirectory() as folder:
                cuboct.set_program_directory(folder)
                try:
                    simulation = cuboct.Simulation(text("heat", steps=10), "gpu", precision=precision)
                    with self.assertRaises(cuboct.InputError) as caught:
                        simulation.step()
                finally:
                    cuboct.set_program_directory(PROGRAMS)
            self.assertEqual(caught.exception.message, "the gpu engine is not built: no program cuboct-gpu beside cuboct")

    def test_a_scene_of_its_own_names_files_beside_it(self):
        """A changed scene is a copy elsewhere: its rule file lies where the scene was."""
        scene = text("heat")
        scene["rule"]["parameters"] = {"conductivity": "100 W/(m*K)"}
        with gpu_on_the_host(self):
            there = cuboct.run(scene, "gpu", steps=3, rule_code="interpreted")
        alike(self, there, cuboct.run(scene, "golden", steps=3))


class Reals(unittest.TestCase):
    """The gpu engine in floats and doubles: its bits depend on its lists too, which its checkpoints have."""

    def steps(self, scene, precision, steps, rtol, **options):
        """In parts of the program, and as one run of it; energies are the reference's of the same state."""
        whole = cuboct.run(scene, "gpu", steps=sum(steps), precision=precision, **options)
        there = cuboct.Simulation(scene, "gpu", precision=precision, probe_every=3, **options)
        for part in steps:
            there.step(part)
        self.assertEqual(there.steps, whole.steps)
        self.assertEqual(there.positions.tolist(), whole.positions.tolist())
        self.assertEqual(there.velocities.tolist(), whole.velocities.tolist())
        self.assertEqual(set(there.fields), set(whole.fields))
        for name in whole.fields:
            self.assertEqual(there.fields[name].tolist(), whole.fields[name].tolist(), name)
        total = whole.curves["energy.total"][-1]
        self.assertAlmostEqual(there.energies["total"], total, delta=rtol * abs(total))
        return there

    def test_pieces_are_one_run(self):
        block = cuboct.Scene.load(scene_file("lj_block.toml"))
        with gpu_on_the_host(self):
            heat = self.steps(text("heat"), "float", (2, 4, 1), 1e-5)
            self.assertLess(heat.fields["T"].max(), 400.001)
            self.steps(pulled(), "double", (3, 4), 1e-9)
            self.steps(text("langevin"), "double", (5, 30, 5), 1e-9, gpus=2)
            self.steps(block, "float", (20, 30, 1), 1e-4)
            with self.assertRaises(cuboct.InputError) as caught:
                heat.set_gravity([0, 0, 1])
            self.assertIn("is a program that reads the scene", caught.exception.message)

    def test_a_run_goes_on_from_one(self):
        with gpu_on_the_host(self):
            first = cuboct.Simulation(text("langevin"), "gpu", precision="double", probe_every=0)
            first.step(4)
            second = cuboct.Simulation(text("langevin"), "gpu", precision="double", probe_every=0, start=first)
            self.assertEqual(second.positions.tolist(), first.positions.tolist())
            second.step(2)
            self.assertEqual(second.steps, 2)
            self.assertNotEqual(second.positions.tolist(), first.positions.tolist())

    def test_a_step_that_cannot_be_done(self):
        scene = text("langevin")
        scene["velocity"][0]["thermal_energy"] = 1e9
        with gpu_on_the_host(self):
            with self.assertRaises(cuboct.RunError) as caught:
                cuboct.run(scene, "gpu", precision="double")
            whole = caught.exception
            simulation = cuboct.Simulation(scene, "gpu", precision="double", probe_every=0)
            for _ in range(2):
                with self.assertRaises(cuboct.RunError) as caught:
                    simulation.run()
                self.assertEqual((str(caught.exception), caught.exception.step), (str(whole), whole.step))
                self.assertEqual(simulation.steps, whole.step)


class Refusals(unittest.TestCase):
    def test_machines_run_it(self):
        scene = text("heat", steps=4)
        run = cuboct.run(scene, "systemc")
        self.assertEqual(run.hashes.tolist(), cuboct.run(scene, "golden").hashes.tolist())
        self.assertEqual(run.cycles.shape[0], 4)
        stepped, golden = cuboct.Simulation(scene, "systemc"), cuboct.Simulation(scene, "golden")
        stepped.step(2), stepped.step(2), golden.step(4)
        self.assertEqual(stepped.hash, golden.hash)
        self.assertTrue(cuboct.crosscheck(scene, ["golden", "lattice", "systemc"], steps=2))

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
