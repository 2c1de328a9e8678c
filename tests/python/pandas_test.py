# SPDX-License-Identifier: MIT
"""Tables of runs as pandas and gnuplot take them: curves of a run in Python and in a file, a measure. Ends with 77 without pandas."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from support import PROGRAMS, main

import cuboct

try:
    import pandas
except ImportError:
    print("skipped: no pandas (python3-pandas)")
    sys.exit(77)

STEPS = 400
STRESS = "tension.stress (Pa)"


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scene = cuboct.Scene.like("tension")
        scene["packing"]["pitch"] = "0.8 mm"
        cls.run_ = cuboct.run(scene, steps=STEPS)
        cls.frame = pandas.DataFrame(cls.run_.table())
        cls.folder = tempfile.TemporaryDirectory()
        path = os.path.join(cls.folder.name, "scene.toml")
        scene.save(path)
        cls.out = os.path.join(cls.folder.name, "out")
        subprocess.run([os.path.join(PROGRAMS, "cuboct"), "run", path, "--steps", str(STEPS), "--quiet", "--csv", "--out", cls.out], check=True,
                       stdout=subprocess.DEVNULL)
        cls.csv = os.path.join(cls.out, "curves.csv")
        cls.read = pandas.read_csv(cls.csv, float_precision="round_trip")  # its own is off by a bit here and there

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_a_table_has_each_curve_with_its_own_samples(self):
        frame, curves = self.frame, self.run_.curves
        self.assertEqual(list(frame.columns[:2]), ["step", "time"])
        self.assertTrue(frame["step"].is_monotonic_increasing and frame["step"].is_unique)
        stress = frame.dropna(subset=["tension.stress"])
        np.testing.assert_array_equal(stress["step"], curves["step"])
        np.testing.assert_array_equal(stress["tension.stress"], curves["tension.stress"])
        energy = frame.dropna(subset=["energy.total"])
        self.assertLess(len(energy), len(frame))
        np.testing.assert_array_equal(energy["energy.total"], curves["energy.total"])

    def test_the_file_is_the_same_table_with_units(self):
        self.assertEqual([name.split(" (")[0] for name in self.read.columns], list(self.frame.columns))
        self.assertIn(STRESS, self.read.columns)
        for mine, name in zip(self.frame.columns, self.read.columns):
            np.testing.assert_array_equal(self.frame[mine].to_numpy(float), self.read[name].to_numpy(float), name)

    @unittest.skipUnless(shutil.which("gnuplot"), "no gnuplot")
    def test_gnuplot_reads_the_file(self):
        column = list(self.read.columns).index(STRESS) + 1
        script = (f"set datafile separator ','; stats '{self.csv}' using {column} every ::1 name 'S' nooutput; set print '-'; "
                  "print sprintf('%.17g %d', S_max, S_records)")
        most, records = subprocess.run(["gnuplot", "-e", script], check=True, capture_output=True, text=True).stdout.split()
        self.assertEqual(float(most), self.read[STRESS].max())
        self.assertEqual(int(records), self.read[STRESS].count())

    def test_a_measure_is_a_table(self):
        rdf = cuboct.measure(self.out, "rdf")
        frame = pandas.DataFrame({name: column for name, column in rdf.items() if name not in ("units", "notes")})
        self.assertGreater(len(frame), 10)
        self.assertGreater(frame.iloc[:, 1].max(), 1)  # the neighbours of a packing


if __name__ == "__main__":
    main()
