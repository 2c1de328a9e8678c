# SPDX-License-Identifier: MIT
"""Tests the studies of materials.

    check.py STUDIES CUBOCT small NAME   the small version of a study ends well, with tables and pictures
    check.py STUDIES CUBOCT red NAME     the same with a defect ends with a figure that is off
    check.py STUDIES CUBOCT page         the study of docs/user/material-studies.md runs as it stands there
    check.py STUDIES CUBOCT parts        cases are run once, again when they change, and go on when they were cut"""
import contextlib
import importlib
import io
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

STUDIES, CUBOCT, WHAT = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
sys.path.insert(0, str(STUDIES))


def anisotropy(module):
    module.CASES["fibres along x"] = ("y", *module.CASES["fibres along x"][1:])


def hysteresis(module):
    whole = module.specimen

    def elastic(factor):
        scene = whole(factor)
        del scene["law"]["force"], scene["law"]["r"], scene["law"]["core"]
        scene["law"] = {"kind": "elastic", "stiffness": "1 MN/m"}
        return scene

    module.specimen = elastic


def chiral(module):
    face = module.face
    module.face = lambda hand: face(abs(hand))


def pitch(module):
    module.TAIL += 3.0


def bend(module):
    bond = module.bond

    def tough(turn, pitch):
        stiffness, peak, energy = bond(turn, pitch)
        return stiffness, peak, 1.6 * energy

    module.bond = tough


def branching(module):
    module.GC *= 0.5  # of the load, not of the law
    law = module.law

    def tough(pitch):
        module.GC *= 2
        found = law(pitch)
        module.GC /= 2
        return found

    module.law = tough


def dcb(module):
    module.GIC *= 1.5


def griffith(module):
    body = module.body

    def slipping(*arguments):
        scene = body(*arguments)
        scene["constraint"][0]["axes"] = "x"
        return scene

    module.body = slipping


def holed(module):
    peak = module.peak

    def tough(pitch, tail):
        strain, stiffness = peak(pitch, tail)
        return 1.3 * strain, stiffness

    module.peak = tough


def kalthoff(module):
    module.ENERGY *= 6


def run(name, out, defect=None):
    """What the small version prints, and how it ends."""
    sys.argv = [name, "--small", "--jobs", "1", "--cuboct", CUBOCT, "--out", out]
    module = importlib.import_module(name)
    if defect:
        defect(module)
    text = io.StringIO()
    try:
        with contextlib.redirect_stdout(text):
            module.run()
    except SystemExit as end:
        return text.getvalue(), str(end)
    return text.getvalue(), ""


def small(name):
    with tempfile.TemporaryDirectory() as out:
        text, end = run(name, out)
        print(text)
        assert not end, end
        left = {file.suffix for file in pathlib.Path(out).iterdir()}
        assert ".tsv" in left, left


def red(name):
    with tempfile.TemporaryDirectory() as out:
        text, end = run(name, out, globals()[name])
        print(text, end)
        assert end, "the study does not see its defect"


SCENE = """
density = "1 g/cm^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "box"
size = "[12, 12, 12] mm"
[law]
kind = "elastic"
stiffness = "1 kN/m"
[[velocity]]
thermal_speed = "1 mm/s"
seed = 1
[run]
steps = STEPS
"""
PROGRAM = """import sys
sys.path.insert(0, STUDIES)
import cuboct
from study import Study, main
def run():
    case = Study("parts", "A study of one case.").run({"one/block": cuboct.Scene.load(SCENE)})["one/block"]
    print(case.value("steps"), case.value("state_hash"), len(list(case.frames())))
main(run)
"""


def parts():
    with tempfile.TemporaryDirectory() as directory:
        work = pathlib.Path(directory)
        program, scene = work / "parts.py", work / "scene.toml"
        program.write_text(PROGRAM.replace("STUDIES", repr(str(STUDIES))).replace("SCENE", repr(str(scene))))
        case = lambda out: work / out / "cases/one per block"

        def start(steps, out):
            scene.write_text(SCENE.replace("STEPS", str(steps)))
            command = [sys.executable, program, "--cuboct", CUBOCT, "--out", work / out, "--jobs", "1"]
            return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)

        def whole(steps, out):
            process = start(steps, out)
            text, errors = process.communicate()
            assert process.returncode == 0, errors
            return text

        written = lambda: (case("out") / "trace.h5").stat().st_mtime_ns
        first = whole(50, "out")
        before = written()
        assert whole(50, "out") == first and written() == before, "a finished case was run again"
        assert whole(100, "out") != first and written() != before, "a changed case was not run again"

        # Cut once it runs: the same command goes on, and ends as if nothing had been.
        process = start(15000, "cut")
        while not (case("cut") / "run.toml").exists() and process.poll() is None:
            time.sleep(0.05)
        time.sleep(0.1)
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate()
        assert process.returncode == 130 and "goes on with what is left" in errors, (process.returncode, errors)
        assert (case("cut") / "checkpoint").exists(), list(case("cut").iterdir())
        assert whole(15000, "cut") == whole(15000, "once")


def page():
    text = (STUDIES.parent.parent / "docs/user/material-studies.md").read_text()
    program = re.search(r"```python\n(.*?)```", text, re.S)[1]
    with tempfile.TemporaryDirectory() as work:
        file = pathlib.Path(work) / "cube.py"
        file.write_text(program)
        done = subprocess.run([sys.executable, file, "--cuboct", CUBOCT, "--out", work], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": f"{STUDIES}:{os.environ['PYTHONPATH']}"})
        assert done.returncode == 0, done.stderr
        stress = [float(line.split()[-1]) for line in done.stdout.splitlines() if line.startswith("pitch")]
        assert len(stress) == 3 and max(stress) < 1.3 * min(stress), done.stdout


globals()[WHAT](*sys.argv[4:])
