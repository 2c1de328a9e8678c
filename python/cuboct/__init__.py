# SPDX-License-Identifier: MIT
"""Particle matter and the hardware that computes it: one rule, the same bits everywhere.

    import cuboct
    scene = cuboct.Scene.like("tension")
    scene["law"]["youngs_modulus"] = "4 GPa"
    simulation = cuboct.Simulation(scene)
    simulation.step(1000)
    simulation.curves["tension.stress"]  # Pa

`Simulation` is stepped, `run` runs any engine to the end, `crosscheck` compares engines bit by bit, `explore` runs a study, `measure` looks
at the frames of a run. What is given wrong raises `InputError`, a step that cannot be done `RunError`. The tutorial is docs/user/python.md.
"""
import os as _os
import shutil as _shutil

from . import _cuboct
from ._errors import InputError, RunError
from ._measure import Measured, measure
from ._particles import write_particles
from ._run import Comparison, Frame, Run, crosscheck, explore, run
from ._scene import Arch, Scene
from ._simulation import Simulation
from ._view import View

__version__: str = _cuboct.version
__all__ = [
    "Arch", "Comparison", "Frame", "InputError", "Measured", "Run", "RunError", "Scene", "Simulation", "View", "crosscheck", "explore",
    "measure", "run", "set_program_directory", "write_particles",
]  # fmt: skip


def set_program_directory(directory: "str | _os.PathLike[str]") -> None:
    """Where the programs of engines are, such as cuboct-systemc.

    At first: beside this package, in the build directory that it is of, or where the `cuboct` of PATH is, whichever has a `cuboct` first.
    """
    _cuboct.set_program_directory(_os.fspath(directory))


def _find_programs() -> None:
    package = _os.path.dirname(_os.path.realpath(__file__))
    build = _os.path.dirname(_os.path.dirname(package))  # build/python/cuboct
    own = [package] + ([build] if _os.path.exists(_os.path.join(build, "CMakeCache.txt")) else [])
    _cuboct.look_for_parts_in(own)
    for directory in own:
        if _os.access(_os.path.join(directory, "cuboct"), _os.X_OK):
            return set_program_directory(directory)
    if found := _shutil.which("cuboct"):
        set_program_directory(_os.path.dirname(_os.path.realpath(found)))


_find_programs()
