#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Damaged files through the commands that read them: each is read, or refused in a line; no command crashes, hangs,
takes all memory or leaves a file. usage: run.py KIND CUBOCT COUNT; KIND: meshes."""
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import meshes
from mutations import mutate

SECONDS, BYTES = 60, 8 << 30  # of processor time and address space, of a command with all that it starts
SCENE = """density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "mesh"
file = "{file}"
{unit}
[law]
kind = "elastic"
stiffness = "1 kN/m"
[run]
dt = "auto"
steps = 3
"""


class Commands:
    def __init__(self, cuboct, folder):
        self.cuboct, self.folder = cuboct, folder
        self.ends = {}

    def run(self, *words):
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
            resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))

        environment = {**os.environ, "TMPDIR": str(self.folder / "tmp")}
        return subprocess.run([self.cuboct, *words], cwd=self.folder, preexec_fn=limit, capture_output=True, env=environment)

    def judge(self, case, *words):
        """What is wrong with how it ends; empty: nothing."""
        before = sorted(p.name for p in self.folder.iterdir())
        done = self.run(*words)
        self.ends[done.returncode] = self.ends.get(done.returncode, 0) + 1
        said = done.stderr.decode(errors="replace")
        wrong = []
        if done.returncode not in (0, 2):
            wrong.append(f"ends with {done.returncode}: {said[:300]}")
        elif done.returncode == 2 and (not said.strip() or len(said) > 1000 or re.search(r"[\x00-\x09\x0b-\x1f]", said)):
            wrong.append(f"refuses in {len(said)} characters: {said[:300]!r}")
        if sorted(p.name for p in self.folder.iterdir()) != before or list((self.folder / "tmp").iterdir()):
            wrong.append("leaves files")
        return [f"{case}: {' '.join(words)} {w}" for w in wrong]


def of_meshes(commands, count):
    for name, data in meshes.FILES.items():
        unit = "" if name.endswith(meshes.STATED) else 'unit = "mm"'
        (commands.folder / "scene.toml").write_text(SCENE.format(file=name, unit=unit))
        (commands.folder / name).write_bytes(data)
        whole = commands.run("check", "scene.toml")
        if whole.returncode != 0 or b"volume 7.2e-08 m^3" not in whole.stdout:
            yield f"{name}, whole: {whole.stdout.decode()}{whole.stderr.decode()}"
        for k in range(count // len(meshes.FILES)):
            (commands.folder / name).write_bytes(mutate(data, f"{name} {k}"))
            yield from commands.judge(f"{name} {k}", "check", "scene.toml")


KINDS = {"meshes": of_meshes}


def main():
    kind, cuboct, count = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        commands = Commands(cuboct, Path(folder))
        (commands.folder / "tmp").mkdir()
        wrong = list(KINDS[kind](commands, int(count)))
    print("\n".join(wrong))
    print(f"{sum(commands.ends.values())} damaged files: {commands.ends}")
    sys.exit(bool(wrong) or commands.ends.get(2, 0) == 0)


main()
