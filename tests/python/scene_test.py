# SPDX-License-Identifier: MIT
"""Scenes as dicts: what is written is what was meant."""
import glob
import json
import os
import tempfile
import tomllib
import unittest

import numpy as np

from support import ROOT, command, main, scene_file

import cuboct


class Scenes(unittest.TestCase):
    def assert_same(self, a, b):
        """Types included: True is not 1, and 1 is not 1.0."""
        self.assertEqual(json.dumps(a, sort_keys=True), json.dumps(b, sort_keys=True))

    def test_every_scene_survives_writing(self):
        files = glob.glob(os.path.join(ROOT, "scenes", "**", "*.toml"), recursive=True)
        self.assertGreater(len(files), 60)
        for path in files:
            read = cuboct.Scene.load(path)
            with open(path, encoding="utf-8") as file:
                self.assertEqual(read.toml(), file.read())
            self.assert_same(tomllib.loads(cuboct.Scene(dict(read)).toml()), read)

    def test_texts_and_names(self):
        awkward = {
            "title": 'a "quoted" \\ line\nand \t \x7f \x01 µ',
            "odd key.": 1,
            "regions": {"a b": {"shape": "box", "of": [{"x": [1, 2.5, True]}, {"y": "z"}]}, "empty": {}},
            "probe": [{"name": "p"}, {}],
            "none": [],
            "numbers": [1e300, -0.0, 5e-324, 1 / 3, 2**62],
        }
        self.assert_same(tomllib.loads(cuboct.Scene(awkward).toml()), awkward)

    def test_numbers_of_numpy(self):
        scene = cuboct.Scene(a=np.float64(0.1), b=np.int64(3), c=np.array([1.5, 2]), d=np.float32(0.5), e=np.bool_(True), f=(1, 2))
        self.assert_same(
            tomllib.loads(scene.toml()), {"a": 0.1, "b": 3, "c": [1.5, 2.0], "d": 0.5, "e": True, "f": [1, 2]}
        )

    def test_templates_are_those_of_the_command(self):
        names = [line.split()[0] for line in command("new", "--list").splitlines()]
        self.assertGreater(len(names), 5)
        with tempfile.TemporaryDirectory() as folder:
            for name in names:
                path = os.path.join(folder, name)
                command("new", path, "--like", name)
                with open(path + ".toml", encoding="utf-8") as file:
                    self.assertEqual(cuboct.Scene.like(name).toml(), file.read())
                self.assertIn(name, cuboct.Scene.like.__doc__)

    def test_a_change_is_seen_and_a_copy_is_its_own(self):
        scene = cuboct.Scene.load(scene_file("coupon.toml"))
        other = scene.copy()
        other["packing"]["pitch"] = "2 mm"
        self.assertLess(other.check()["particles"], scene.check()["particles"])
        self.assertNotEqual(scene, other)
        other["packing"]["pitch"] = scene["packing"]["pitch"]
        self.assertEqual(other.toml(), scene.toml())

    def test_probes_tell_what_they_are_off_by(self):
        scene = cuboct.Scene.like("tension")
        told = scene.check()["probes"]["tension"]
        stress, strain = told["errors"]
        self.assertEqual([stress["quantity"], stress["unit"], strain["quantity"]], ["stress", "1", "strain"])
        self.assertFalse(stress["of_means"])
        self.assertIn(f"stress within about {100 * stress['error']:.2g} %", told["text"])
        scene["probe"][0]["accuracy"] = stress["error"] / 3
        self.assertLessEqual(scene.check()["probes"]["tension"]["errors"][0]["error"], stress["error"] / 3)

    def test_the_command_reads_what_is_saved(self):
        scene = cuboct.Scene.like("tension")
        scene["packing"]["pitch"] = "1 mm"
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "bar.toml")
            scene.save(path)
            self.assertIn(f"{scene.check()['particles']} particles", command("check", path).replace(",", ""))


main()
