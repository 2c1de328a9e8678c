# SPDX-License-Identifier: MIT
"""The page of a run and of a simulation: what it holds is what Python holds."""
import base64
import html
import json
import os
import pickle
import re
import tempfile
import unittest
import zlib

import numpy as np
from support import main, scene_file

import cuboct


class Page:
    """What stands in a page (docs/reference/view.md)."""

    def __init__(self, text):
        self.text = text
        self.story = json.loads(re.search(r'<script type="application/json" id="story">(.*?)</script>', text, re.S)[1])

    def steps(self):
        return [frame["step"] for frame in self.story["frames"]]

    def block(self, frame, index):
        form = self.story["head"]["blocks"][index]
        packed = re.search(rf'id="b{frame}-{index}">(.*?)</script>', self.text, re.S)[1]
        width = {"u8": 1, "u16": 2, "f32": 4, "f64": 8, "words": 8}[form["number"]]
        parted = np.frombuffer(zlib.decompress(base64.b64decode(packed)), np.uint8)
        joined = np.ascontiguousarray(parted.reshape(width, -1).T)
        kind = {"u8": np.uint8, "u16": "<u2", "f32": "<f4", "f64": "<f8", "words": "<i8"}[form["number"]]
        return joined.reshape(-1).view(kind).reshape(self.story["head"]["shown"], -1)

    def places(self, frame):
        entry = self.story["frames"][frame]
        return np.array(entry["lower"]) + self.block(frame, 0) / 65534 * np.array(entry["extent"])


class Views(unittest.TestCase):
    def check_places(self, page, frame, positions):
        apart = np.abs(page.places(frame) - positions).max(axis=0)
        self.assertTrue((apart <= np.array(page.story["frames"][frame]["extent"]) / 65534).all(), apart)

    def test_of_a_run_has_its_frames_curves_and_bits(self):
        run = cuboct.run(scene_file("two_types.toml"), steps=40, frame_every=20)
        page = Page(run.view().html)
        self.assertEqual(page.steps(), [0, 20, 40])
        for k, frame in enumerate(run.frames):
            self.check_places(page, k, frame.positions)
        self.assertEqual(page.story["head"]["blocks"][2]["number"], "words")
        curves = {curve["name"]: curve["value"] for curve in page.story["curves"]}
        names = [name for name in run.units if name in curves]
        self.assertGreater(len(names), 3)
        for name in names:
            self.assertEqual(curves[name], run.curves[name].tolist())
        part = Page(run.view(every=2, particles=50).html)
        self.assertEqual((part.steps(), part.story["head"]["shown"]), ([0, 40], 50))

    def test_of_doubles_has_them(self):
        run = cuboct.run(scene_file("lj_block.toml"), "reference", steps=10, frame_every=10)
        page = Page(run.view().html)
        for k, frame in enumerate(run.frames):
            self.assertTrue((page.block(k, 2) == np.hstack([frame.positions, frame.velocities])).all())

    def test_of_stages_and_of_starts(self):
        scene = cuboct.Scene.load(scene_file("lj_block.toml"))
        scene["stage"] = [{"name": "first", "steps": 10}, {"name": "second", "steps": 5}]
        run = cuboct.run(scene, frame_every=5)
        self.assertEqual(Page(run.view().html).steps(), [0, 5])
        self.assertEqual(Page(run.stages["first"].view().html).steps(), [0, 5, 10])
        simulation = cuboct.Simulation(scene, stage="first")
        simulation.run()
        second = cuboct.Simulation(scene, stage="second", start=simulation)
        second.step(3)
        page = Page(second.view().html)
        self.assertEqual(page.steps(), [3])
        self.check_places(page, 0, second.positions)

    def test_of_a_simulation_has_its_state(self):
        for engine in ("lattice", "reference"):
            simulation = cuboct.Simulation(scene_file("coupon.toml"), engine)
            for steps in (0, 1, 30):
                simulation.step(steps)
                page = Page(simulation.view().html)
                self.assertEqual(page.steps(), [simulation.steps])
                self.check_places(page, 0, simulation.positions)
                self.assertEqual(page.story["head"]["engine"], engine)
            simulation.set_velocity("pulled", [0, 0, 0])
            simulation.step(20)
            page = Page(simulation.view().html)  # of another plan than the scene's: doubles
            self.assertEqual(page.steps(), [51])
            self.assertTrue((page.block(0, 2) == np.hstack([simulation.positions, simulation.velocities])).all())

    def test_of_a_text_has_its_fields(self):
        simulation = cuboct.Simulation(scene_file("rules/heat.toml"), "lattice")
        simulation.step(20)
        page = Page(simulation.view().html)
        names = [block["name"] for block in page.story["head"]["blocks"]]
        shown = page.block(0, names.index("T"))[:, 0]
        self.assertTrue((shown == simulation.fields["T"].astype(np.float32)).all())

    def test_a_notebook_gets_a_frame_and_a_file_the_page(self):
        run = cuboct.run(scene_file("lj_block.toml"), steps=2)
        view = run.view(height=500)
        shown = view._repr_html_()
        self.assertIn("height: 500px", shown)
        self.assertIn('sandbox="allow-scripts allow-downloads"', shown)
        self.assertEqual(html.unescape(re.search(r'srcdoc="([^"]*)"', shown)[1]), view.html)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "run.html")
            view.save(path)
            with open(path, encoding="utf-8") as file:
                self.assertEqual(file.read(), view.html)

    def test_refusals(self):
        run = cuboct.run(scene_file("lj_block.toml"), steps=2)
        with self.assertRaisesRegex(cuboct.InputError, "every is a whole number from 1 on, not 0"):
            run.view(every=0)
        with self.assertRaisesRegex(cuboct.InputError, "^the page would take some .* of --limit") as caught:
            cuboct.run(scene_file("coupon.toml"), steps=60, frame_every=1).view(limit=1)
        self.assertIn("--limit", caught.exception.hint)
        with self.assertRaisesRegex(cuboct.InputError, "pickled"):
            pickle.loads(pickle.dumps(run)).view()


if __name__ == "__main__":
    main()
