# SPDX-License-Identifier: MIT
"""A study's table is what its store holds."""
import os
import sqlite3
import tempfile
import unittest

import numpy as np

from support import main, scene_file

import cuboct


class Study(unittest.TestCase):
    def test_columns(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "block")
            table = cuboct.explore(scene_file("studies/block.toml"), out=out, speed=False)
            points = len(table["settings"])
            self.assertGreater(points, 3)
            self.assertEqual({len(column) for column in table.values()}, {points})
            with sqlite3.connect(os.path.join(out, "results.db")) as store:
                tables = [name for (name,) in store.execute("select name from sqlite_master where type = 'table'")]
                rows = max(store.execute(f"select count(*) from {name}").fetchone()[0] for name in tables)
            self.assertGreaterEqual(rows, points)
            self.assertEqual(set(table["engine"]), {"lattice", "reference"})
            done = np.array([status == "done" for status in table["status"]])
            self.assertGreater(done.sum(), 2)
            self.assertTrue((table["error.trajectory"][done] > 0).all())
            self.assertTrue((table["dt"][done] > 0).all())
            self.assertTrue(np.isnan(table["particle_steps_per_second"]).all())
            # What is there is not measured again: a mark in it stays.
            with sqlite3.connect(os.path.join(out, "results.db")) as store:
                store.execute("update points set trajectory = 0.125 where status = 'done'")
            again = cuboct.explore(scene_file("studies/block.toml"), out=out, speed=False)
            self.assertEqual(set(again["error.trajectory"][done]), {0.125})
            again["error.trajectory"] = table["error.trajectory"]
            self.assertEqual({name: list(map(str, column)) for name, column in table.items()},
                             {name: list(map(str, column)) for name, column in again.items()})  # fmt: skip

    def study_of(self, folder, scene, more):
        path = os.path.join(folder, "s.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'scene = "{scene}"\n{more}')
        return path

    def test_a_rule_of_text(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = cuboct.Scene.load(scene_file("rules/heat.toml"))
            scene["run"].update(steps=40, probe_every=4)
            scene["run"].pop("frame_every")
            scene.save(os.path.join(folder, "heat.toml"))
            figure = '[[figure]]\nkind = "final"\ncurve = "left.T"\n[truth]\nrungs = 3\n'
            sweep = '[[sweep]]\ndt = ["5 ms", "10 ms"]\narithmetic = ["float64", "fixed"]\n'
            table = cuboct.explore(self.study_of(folder, "heat.toml", figure + sweep), out=os.path.join(folder, "out"), speed=False)
            self.assertEqual(table["status"], ["done"] * 4)
            self.assertEqual(sorted(table["engine"]), ["lattice", "lattice", "reference", "reference"])
            values = dict(zip(zip(table["arithmetic"], np.round(table["dt"], 6)), table["final"], strict=True))
            for dt in (0.005, 0.01):
                self.assertAlmostEqual(values["fixed", dt], values["float64", dt], places=5)
            # The two steps are told apart, by far more than integers add.
            self.assertGreater(abs(values["fixed", 0.01] - values["fixed", 0.005]), 1e-4)
            self.assertTrue(np.isnan(table["cost"]).all())
            for name, more, message in (
                ("heat.toml", sweep + '[search]\ndt = ["5 ms", "10 ms"]\n', "a search is for the least hardware"),
                (os.path.abspath(scene_file("rules/langevin.toml")), "samples = 4\n" + sweep, "the scene's rule draws noise"),
            ):
                with self.assertRaisesRegex(cuboct.InputError, message):
                    cuboct.explore(self.study_of(folder, os.path.join(folder, name), more), out=os.path.join(folder, "no"))

    def test_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "s.toml")
            with open(path, "w", encoding="utf-8") as file:
                file.write('scene = "nowhere.toml"\n')
            with self.assertRaises(cuboct.InputError) as caught:
                cuboct.explore(path, out=os.path.join(folder, "out"))
            self.assertEqual((caught.exception.file, caught.exception.line), (path, 1))
            self.assertFalse(os.path.exists(os.path.join(folder, "out")))


main()
