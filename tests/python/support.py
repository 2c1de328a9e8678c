# SPDX-License-Identifier: MIT
"""usage of each test: NAME_test.py ROOT DIRECTORY_OF_CUBOCT"""
import os
import subprocess
import sys
import unittest

ROOT, PROGRAMS = sys.argv[1:3]
os.environ["PATH"] = PROGRAMS + ":" + os.environ["PATH"]


def scene_file(name):
    return os.path.join(ROOT, "scenes", name)


def command(*arguments):
    """What `cuboct` prints on stdout; its exit code must be 0."""
    return subprocess.run(
        [os.path.join(PROGRAMS, "cuboct"), *arguments], check=True, capture_output=True, text=True
    ).stdout


def main():
    unittest.main(argv=sys.argv[:1], module="__main__")
