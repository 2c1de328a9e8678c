#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Files that versions left are read by this one, or refused with the version that they have.

usage: check.py CUBOCT [project] [synth]; tests/samples/VERSION holds a run of scene.toml, its checkpoint, the results of study.toml and a project
that was emitted of the scene, without its pages. Those that are of another version, by one word, must be refused: the check sees that.
project: the build has `cuboct synth`, which reads projects; synth: it does so here, for seconds."""
import gzip
import json
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
REFUSED = re.compile(r"version \d+")
RESUME = ["run", "scene.toml", "--engine", "golden", "--steps", "24", "--frames", "none", "--checkpoint-every", "6 steps", "--quiet", "--out", "run",
          "--resume"]
SYNTH = ["synth", "project", "--target", "hx8k", "--unit", "tick", "--no-place", "--quiet"]
VERSION_AT = 8  # byte of a checkpoint where its version stands


def lay_out(sample, folder):
    for name in ("scene.toml", "study.toml"):
        shutil.copy(HERE / name, folder)
    (folder / "run").mkdir()
    (folder / "study").mkdir()
    with tarfile.open(sample / "project.tar.gz") as project:
        project.extractall(folder)
    for file in sample.iterdir():
        if file.name.startswith("project"):
            continue
        to = folder / ("study" if file.name.startswith("results") else "run")
        if file.suffix == ".gz":
            (to / file.stem).write_bytes(gzip.decompress(file.read_bytes()))
        else:
            shutil.copy(file, to)


def state_hash(folder):
    return json.loads((folder / "run" / "summary.json").read_text())["state_hash"]["value"]


class Check:
    def __init__(self, cuboct, parts):
        self.cuboct, self.parts, self.wrong, self.read = Path(cuboct).resolve(), parts, [], 0

    def takes(self, folder, words, holds=lambda said: True, only_refused=False):
        done = subprocess.run([self.cuboct, *words], cwd=folder, capture_output=True, text=True)
        refused = done.returncode == 2 and REFUSED.search(done.stderr)
        if only_refused and not refused:
            self.wrong.append(f"{' '.join(words)} takes another version: {done.returncode} {done.stderr}")
        elif not refused and (done.returncode != 0 or not holds(done.stdout)):
            self.wrong.append(f"{folder}: {' '.join(words)} ends with {done.returncode}: {done.stdout}{done.stderr}")
        elif not only_refused:
            self.read += not refused

    def of(self, sample, whole):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            lay_out(sample, folder)
            self.takes(folder, ["report", "run", "--out", "run.html"])
            self.takes(folder, ["curves", "run"], lambda said: "grip.force_x" in said)
            self.takes(folder, ["check", "scene.toml", "--from", "run"])
            self.takes(folder, ["explore", "study.toml", "--no-speed", "--jobs", "1", "--out", "study"], lambda said: "4 points" in said)
            checkpoint = folder / "run" / "checkpoint"
            held = checkpoint.read_bytes()
            checkpoint.write_bytes(held[:VERSION_AT] + struct.pack("<Q", 99) + held[VERSION_AT + 8:])
            self.takes(folder, RESUME, only_refused=True)
            checkpoint.write_bytes(held)
            self.takes(folder, RESUME, lambda said: state_hash(folder) == whole)
            if "synth" in self.parts:
                self.takes(folder, SYNTH, lambda said: "LUT" in said)
            if "project" in self.parts:
                described = folder / "project" / "project.json"
                described.write_text(described.read_text().replace('"version": 1,', '"version": 99,'))
                self.takes(folder, SYNTH, only_refused=True)


def main():
    check = Check(sys.argv[1], sys.argv[2:])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(HERE / "scene.toml", folder)
        subprocess.run([check.cuboct, *RESUME[:-1]], cwd=folder, check=True, capture_output=True)
        whole = state_hash(folder)
    samples = sorted(p for p in HERE.iterdir() if p.is_dir())
    for sample in samples:
        check.of(sample, whole)
    print("\n".join(check.wrong))
    print(f"{len(samples)} versions, {check.read} commands read their files")
    sys.exit(bool(check.wrong) or not samples)


main()
