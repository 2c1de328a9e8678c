# SPDX-License-Identifier: MIT
"""What the command runs, Python runs by itself: files of scenes/ by both, with the same engine, bits and refusals.

usage: scenes_test.py ROOT DIRECTORY_OF_CUBOCT [all]; "all" takes every file, else a few that cost little, of each kind one
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from support import PROGRAMS, ROOT, main

import cuboct

STEPS = 2
ALL = "all" in sys.argv[3:]
# Pairs, types, rules of rounds, static loading, stages, and two that are no scenes.
QUICK = ("lj_block", "two_types", "cracked_glass", "graphene", "studies/pitch_bar", "templates/release", "archs/small", "studies/block")
# What a clock says.
TIMES = {"host_time", "speed", "particle-steps_per_second", "seconds"}


def files():
    scenes = Path(ROOT) / "scenes"
    return sorted(scenes.rglob("*.toml")) if ALL else [scenes / f"{name}.toml" for name in QUICK]


def by_the_command(path, stage):
    words = [os.path.join(PROGRAMS, "cuboct"), "run", path, "--json", "--quiet", "--steps", str(STEPS)]
    with tempfile.TemporaryDirectory() as folder:
        if stage:
            words += ["--stage", stage, "--out", os.path.join(folder, "out"), "--frames", "none"]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode not in (0, 1):
            return None, json.loads(done.stderr)["error"]
        if stage:
            return json.loads(next(Path(folder).glob("out/1-*/summary.json")).read_text()), None
        return json.loads(done.stdout), None


def by_python(path, stage):
    try:
        return cuboct.run(path, steps=STEPS, stage=stage), None
    except cuboct.InputError as error:
        parts = ("message", "file", "line", "column", "hint")
        return None, {part: getattr(error, part) or None for part in parts}
    except cuboct.RunError as error:
        return error.run, None


def told(summary):
    return {name: value for name, value in summary.items() if name not in TIMES}


class Scenes(unittest.TestCase):
    def test_both_ways(self):
        engines, refused = {}, 0
        for path in files():
            with self.subTest(path.name):
                try:
                    stages = cuboct.Scene.load(path).get("stage")
                    stage = stages[0]["name"] if stages else None
                except cuboct.InputError:
                    stage = None
                summary, error = by_the_command(path, stage)
                run, same_error = by_python(path, stage)
                self.assertEqual(same_error, error)
                if run is None:
                    refused += 1
                    continue
                self.assertEqual(told(run.summary), told(summary))
                self.assertEqual(run.hash, summary.get("state_hash", {}).get("value"))
                simulation = cuboct.Simulation(path, stage=stage, probe_every=0)
                simulation.step(run.steps)
                self.assertEqual(simulation.engine, run.engine)
                self.assertEqual(simulation.hash, run.hash)
                self.assertEqual(simulation.positions.tolist(), run.positions.tolist())
                self.assertEqual(simulation.velocities.tolist(), run.velocities.tolist())
                self.assertEqual(cuboct.Scene.load(path).check()["engine"], run.engine)
                engines[run.engine] = engines.get(run.engine, 0) + 1
        self.assertGreaterEqual(engines["lattice"], 40 if ALL else 3)
        self.assertGreaterEqual(engines["reference"], 3)  # rules of rounds, and static loading
        self.assertGreaterEqual(refused, 20 if ALL else 2)  # studies and archs


main()
