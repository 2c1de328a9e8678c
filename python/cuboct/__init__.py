# SPDX-License-Identifier: MIT
"""Particle matter and the hardware that computes it: one rule, the same bits everywhere.

    import cuboct
    scene = cuboct.Scene.like("tension")
    scene["law"]["youngs_modulus"] = "4 GPa"
    simulation = cuboct.Simulation(scene)
    simulation.step(1000)
    simulation.curves["tension.stress"]  # Pa

`Simulation` is stepped, `run` runs any engine to the end, `crosscheck` compares engines bit by bit, `explore` runs a study. What is given wrong
raises `InputError`, a step that cannot be done `RunError`. The tutorial is docs/user/python.md.
"""
import os as _os
import shutil as _shutil

from . import _cuboct
from ._errors import InputError, RunError
from ._run import Comparison, Frame, Run, crosscheck, explore, run
from ._scene import Arch, Scene
from ._simulation import Simulation

__version__: str = _cuboct.version
__all__ = [
    "Arch", "Comparison", "Frame", "InputError", "Run", "RunError", "Scene", "Simulation", "crosscheck", "explore", "run",
    "set_program_directory",
]  # fmt: skip


def set_program_directory(directory: "str | _os.PathLike[str]") -> None:
    """Where the programs of engines are, such as cuboct-systemc. At first: where the `cuboct` of PATH is."""
    _cuboct.set_program_directory(_os.fspath(directory))


if _found := _shutil.which("cuboct"):
    set_program_directory(_os.path.dirname(_os.path.realpath(_found)))
