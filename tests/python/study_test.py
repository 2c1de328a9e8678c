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
