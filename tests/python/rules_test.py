# SPDX-License-Identifier: MIT
"""Rules of rounds, static loading, stages and ends that a probe sets."""
import json
import os
import tempfile
import unittest

from support import command, main, scene_file

import cuboct

LEFT = {"shape": "half_space", "point": "[-4, 0, 0] mm", "normal": "x"}
RIGHT = {"shape": "half_space", "point": "[4, 0, 0] mm", "normal": "-x"}


def bar(**changes):
    """Glass that is torn: bonds begin to break within twenty steps."""
    scene = cuboct.Scene(
        density="2 g/cm^3",
        packing={"pitch": "1 mm"},
        geometry={"shape": "box", "size": "[10, 4, 3] mm"},
        rule={"kind": "lps", "youngs_modulus": "70 GPa", "poissons_ratio": 0.3, "critical_stretch": 0.01,
              "damage_width": 0.002},
        constraint=[{"name": "l", "kind": "held", "region": LEFT},
                    {"name": "r", "kind": "moved", "velocity": "[200, 0, 0] m/s", "region": RIGHT}],
        probe=[{"name": "f", "kind": "force", "region": LEFT, "axis": "x"},
               {"name": "way", "kind": "displacement", "region": RIGHT, "axis": "x"}],
        run={"dt": "auto", "steps": 60, "probe_every": 10},
    )  # fmt: skip
    scene["run"].update(changes)
    return scene


def pulled(**changes):
    """A bar of a pair law in three load steps of ten steps."""
    scene = bar(static={"load_steps": 3}, steps=30, **changes)
    scene["law"] = {"kind": "elastic", "youngs_modulus": "3 GPa", "direction": "x"}
    scene["constraint"][1]["velocity"] = "[1, 0, 0] m/s"
    scene["run"]["accuracy"] = 0.1  # the smallest tables: they take most of the time
    del scene["rule"]
    return scene


def same(test, a, b):
    test.assertEqual(a.positions.tolist(), b.positions.tolist())
    test.assertEqual(a.velocities.tolist(), b.velocities.tolist())
    test.assertEqual(set(a.curves), set(b.curves))
    for name in a.curves:
        test.assertEqual(a.curves[name].tolist(), b.curves[name].tolist(), name)


class Rounds(unittest.TestCase):
    def test_a_rule_of_rounds(self):
        whole = cuboct.run(bar())
        self.assertEqual((whole.engine, whole.hash), ("reference", None))
        same(self, cuboct.run(bar(), "reference", threads=2), whole)
        simulation = cuboct.Simulation(bar())
        self.assertEqual((simulation.engine, simulation.hash), ("reference", None))
        self.assertEqual(simulation.fields["damage"].max(), 0)
        simulation.step(25)
        simulation.run()
        same(self, simulation, whole)
        damage = simulation.fields["damage"]
        self.assertEqual(damage.shape, (simulation.particles,))
        self.assertGreater(damage.max(), 0.1)
        self.assertAlmostEqual(damage.mean(), whole.counters["mean_damage"], places=12)
        self.assertTrue(simulation.picture().startswith(b"\x89PNG"))
        facts = bar().check()
        self.assertEqual((facts["engine"], facts["cells"], facts["nodes"]), ("reference", None, None))

    def test_a_change_keeps_the_bonds(self):
        plain, changed = cuboct.Simulation(bar()), cuboct.Simulation(bar())
        plain.run()
        changed.step(40)
        before = changed.fields["damage"]
        self.assertGreater(before.max(), 0)
        changed.set_velocity("r", [200, 0, 0])
        self.assertEqual(changed.steps, 40)
        changed.run()
        same(self, changed, plain)
        self.assertEqual(changed.fields["damage"].tolist(), plain.fields["damage"].tolist())
        self.assertTrue((changed.fields["damage"] >= before).all())

    def test_engines_of_pairs_refuse(self):
        for call in (
            lambda: cuboct.run(bar(), "lattice"),
            lambda: cuboct.Simulation(bar(), "golden"),
            lambda: cuboct.crosscheck(bar(), ["golden", "lattice"], steps=1),
        ):
            with self.assertRaises(cuboct.InputError) as caught:
                call()
            self.assertIn("knows the pair law alone", caught.exception.message)
            self.assertEqual(caught.exception.hint, "the reference engine runs it")
            self.assertEqual(caught.exception.key, "rule.kind")
        self.assertEqual(cuboct.Simulation(scene_file("lj_block.toml")).fields, {})


class Text(unittest.TestCase):
    def test_a_rule_that_is_text(self):
        scene = cuboct.Scene.load(scene_file("rules/heat.toml"))
        scene["run"].update(steps=40, probe_every=10)
        doubles, integers = cuboct.run(scene), cuboct.run(scene, "golden")
        self.assertEqual((doubles.engine, integers.engine), ("reference", "golden"))
        self.assertIsNotNone(integers.hash)
        self.assertGreater(doubles.curves["left.T"][-1], 306)
        self.assertAlmostEqual(integers.curves["left.T"][-1], doubles.curves["left.T"][-1], places=5)
        self.assertEqual(cuboct.run(scene, "lattice").hash, integers.hash)
        self.assertTrue(cuboct.crosscheck(scene, ["golden", "lattice"], steps=20))
        simulation = cuboct.Simulation(scene)
        simulation.step(40)
        self.assertEqual(simulation.fields["T"].shape, (simulation.particles,))
        self.assertAlmostEqual(simulation.fields["T"].mean(), 350, places=9)


class Static(unittest.TestCase):
    def test_static_loading(self):
        whole = cuboct.run(pulled())
        self.assertEqual((whole.engine, whole.steps), ("reference", 30))
        simulation = cuboct.Simulation(pulled())
        self.assertEqual(simulation.engine, "reference")
        simulation.step(4)
        between = simulation.positions
        simulation.step(5)
        self.assertEqual(simulation.positions.tolist(), between.tolist())  # the body follows at whole load steps
        simulation.step(1)
        self.assertNotEqual(simulation.positions.tolist(), between.tolist())
        simulation.run()
        same(self, simulation, whole)
        # At the speed of the constraint.
        self.assertAlmostEqual(simulation.curves["way.along"][-1] / simulation.time, 1, places=9)
        # Steps are whole load steps.
        self.assertEqual(cuboct.run(pulled(), steps=11).steps, 20)

    def test_a_change_on_the_way(self):
        plain, changed = cuboct.Simulation(pulled()), cuboct.Simulation(pulled())
        plain.run()
        changed.step(10)
        changed.set_velocity("r", [1, 0, 0])
        changed.run()
        same(self, changed, plain)
        held = cuboct.Simulation(pulled())
        held.step(20)
        held.set_velocity("r", [0, 0, 0])
        held.run()
        way = held.curves["way.along"]
        self.assertAlmostEqual(way[-1] / way[-2], 1, places=9)
        self.assertLess(way[-1], 0.7 * plain.curves["way.along"][-1])

    def test_a_change_that_would_tear(self):
        simulation = cuboct.Simulation(pulled())
        with self.assertRaisesRegex(cuboct.InputError, r"set_velocity\('r', \[5000, 0, 0\]\): a load step moves a constraint by"):
            simulation.set_velocity("r", [5000, 0, 0])

    def test_what_static_loading_has_not(self):
        for call, text in (
            (lambda: cuboct.run(pulled(), "lattice"), "static loading is not for the lattice engine"),
            (lambda: cuboct.Simulation(pulled(), "golden"), "static loading is not for the golden engine"),
            (lambda: cuboct.Simulation(pulled(), precision="float"), "static loading is in doubles"),
            (lambda: cuboct.run(pulled(), integrator="verlet"), "static loading has no motion"),
        ):
            with self.assertRaisesRegex(cuboct.InputError, text):
                call()

    def test_a_body_that_finds_no_rest(self):
        scene = pulled()
        scene["run"]["static"]["evaluations"] = 1
        for call in (lambda: cuboct.run(scene), lambda: cuboct.Simulation(scene).run()):
            with self.assertRaisesRegex(cuboct.RunError, "finds no rest"):
                call()


class Until(unittest.TestCase):
    def test_the_end_that_a_probe_sets(self):
        def scene():
            return bar(until={"probe": "way", "above": "0.05 mm"}, steps=10000)

        whole = cuboct.run(scene())
        self.assertIn("way.along", whole.reached)
        self.assertLess(whole.steps, 10000)
        self.assertIsNone(whole.stopped)
        simulation = cuboct.Simulation(scene())
        simulation.run()
        self.assertEqual(simulation.steps, whole.steps)
        simulation.step(1)  # as told
        self.assertEqual(simulation.steps, whole.steps + 1)


def torn(scene):
    """The scene in two stages: torn, then let go."""
    scene["stage"] = [
        {"name": "tear", "steps": 40},
        {"name": "rest", "steps": 20, "constraint": [{"name": "r", "velocity": "[0, 0, 0] m/s"}]},
    ]
    return scene


class Stages(unittest.TestCase):
    """Each begins where the one before ended, with what its bonds went through."""

    def by_the_command(self, scene):
        with tempfile.TemporaryDirectory() as folder:
            scene.save(os.path.join(folder, "scene.toml"))
            summary = command("run", os.path.join(folder, "scene.toml"), "--out", os.path.join(folder, "out"), "--json", "--quiet")
            return [stage["summary"] for stage in json.loads(summary)["stages"]]

    def compare(self, scene):
        run = cuboct.run(scene)
        self.assertEqual(list(run.stages), ["tear", "rest"])
        self.assertIs(run.stages["rest"], run)
        for name, summary in zip(run.stages, self.by_the_command(scene), strict=True):
            for key in ("ended", "energy", "state_hash", "mean_damage", "f.force", "way.along"):
                self.assertEqual(run.stages[name].summary.get(key), summary.get(key), (name, key))
        first = cuboct.Simulation(scene)
        first.run()
        second = cuboct.Simulation(scene, stage="rest", start=first)
        self.assertEqual(second.steps, 0)
        self.assertEqual(second.positions.tolist(), first.positions.tolist())
        second.run()
        same(self, second, run)
        return run, first, second

    def test_bonds_go_on(self):
        run, first, second = self.compare(torn(bar()))
        self.assertGreater(first.fields["damage"].max(), 0)
        self.assertTrue((second.fields["damage"] >= first.fields["damage"]).all())
        self.assertGreaterEqual(run.counters["mean_damage"], run.stages["tear"].counters["mean_damage"])

    def test_a_fixed_rule(self):
        scene = pulled()
        del scene["run"]["static"]
        run, first, second = self.compare(torn(scene))
        self.assertEqual((run.engine, run.hash), ("lattice", second.hash))
        self.assertEqual(cuboct.run(scene, stage="rest", start=first).hash, run.hash)
        found = cuboct.crosscheck(scene, ["golden", "lattice"])
        self.assertTrue(found)
        self.assertEqual(found.steps, 60)
        self.assertIn("stage rest\nmatched", found.text)
        facts = scene.check(stage="rest")
        self.assertEqual((facts["stages"], facts["steps"]), (["tear", "rest"], 20))

    def test_parts_that_are_not_needed(self):
        scene = pulled()
        del scene["run"]["static"]
        scene["stage"] = [
            {"name": "pull", "steps": 30, "parts": 3, "until": {"probe": "way", "above": "1e-9 m"},
             "constraint": [{"name": "r", "velocity": {"from": "[1, 0, 0] m/s", "to": "[2, 0, 0] m/s"}}]},
            {"name": "rest", "steps": 20},
        ]  # fmt: skip
        run = cuboct.run(scene)
        self.assertEqual(list(run.stages), ["pull-1", "rest"])
        self.assertIn("way.along", run.stages["pull-1"].reached)
        self.assertEqual(list(cuboct.run(scene, stage="pull").stages), ["pull-1"])
        self.assertEqual(cuboct.crosscheck(scene, ["golden", "lattice"]).text.count("stage"), 2)

    def test_what_is_asked_wrong(self):
        scene = torn(bar())
        for call, text in (
            (lambda: cuboct.run(scene, steps=3), "each stage has its own steps"),
            (lambda: cuboct.run(scene, stage="tore"), "has no stage 'tore'"),
            (lambda: cuboct.Simulation(scene, stage="rest"), "begins where the stage before it ended"),
            (lambda: cuboct.run(scene, start=3), "3 left no state"),
            (lambda: cuboct.run(scene, start="nowhere"), "nowhere holds no finished run"),
            (lambda: cuboct.run(bar(), stage="rest"), "has no stages"),
        ):
            with self.assertRaisesRegex(cuboct.InputError, text):
                call()


main()
