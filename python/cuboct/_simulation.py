# SPDX-License-Identifier: MIT
"""A simulation that is stepped from Python."""
from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _cuboct
from ._errors import InputError
from ._scene import ArchLike, Scene, SceneLike, _tables, sources
from ._view import View, _view

Start = Union["Simulation", str, "os.PathLike[str]", None]


def _given(**options: Any) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}


def _count(value: int, what: str) -> int:
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or not 0 <= value < 2**63:
        raise InputError(f"{what} is a whole number from 0 to 2^63 - 1, not {value!r}")
    return int(value)


def _vector(value: Sequence[float], what: str) -> tuple[float, float, float]:
    try:
        x, y, z = value
        return float(x), float(y), float(z)
    except (TypeError, ValueError):
        raise InputError(f"{what} has three components, as plain numbers, not {value!r}") from None


class _Folder:
    """A directory that goes with this object."""

    def __init__(self) -> None:
        self.name = tempfile.mkdtemp()
        weakref.finalize(self, shutil.rmtree, self.name, ignore_errors=True)


def _left_by(start: Start, folder: str) -> str:
    """The directory with the state to begin with; that of a simulation is made in `folder`. "": the scene's own start."""
    if start is None:
        return ""
    if isinstance(start, Simulation):
        begin = os.path.join(folder, "start")
        start._of.leave(begin)
        return begin
    if isinstance(start, (str, os.PathLike)):
        return os.fspath(start)
    raise InputError(f"{start!r} left no state", "a Simulation, or the directory of `cuboct run --out`")


class Simulation:
    """A scene in an engine: "lattice" (fast), "golden" (the same bits), "reference" (doubles), or one in a program of its own.

    `engine`: None for the one that the scene asks for: reference for a `[rule]` and for static loading, else lattice. A scene of stages is
    stepped stage by stage: `stage` names one, None is the first, and the next begins where `start`, the simulation of the one before, is now.
    `start` may also be the directory of `cuboct run --out`. A scene with static loading is at rest after each load step; between two of
    them a step moves nothing.

    "systemc", "rtl", "fpga", "gpu", and "lattice" with `ranks`, are programs. A call of `step` runs the program once, and once
    more after each reading of the probes; each run begins with the state reached so far, and the bits are those of one whole run.

    Arrays are copies, by particle id. All quantities are in SI. Long calls let other threads run. Ctrl-C ends one after a whole step
    with KeyboardInterrupt; the simulation then goes on from that step.

    `arch`: the machine, as a `cuboct.Arch`, a dict or a path. `threads`: as many as suit the scene, where None. `precision` ("double" or
    "float") is of the reference and of "gpu", `integrator` ("euler" or "verlet") of the reference. `probe_every`: steps between two readings of the probes and
    energies, 0 for none; None: the scene's own. `anyway`: though it needs more memory than is free. `ranks`, `gpus`, `devices`, `port`,
    `baud` and `rule_code` are the command's options of that name.
    """

    def __init__(
        self,
        scene: SceneLike,
        engine: str | None = None,
        *,
        stage: str | None = None,
        start: Start = None,
        arch: ArchLike = None,
        threads: int | None = None,
        precision: str | None = None,
        integrator: str | None = None,
        rule_code: str | None = None,
        probe_every: int | None = None,
        ranks: int | None = None,
        gpus: int | None = None,
        devices: Sequence[int] | None = None,
        port: str | None = None,
        baud: int | None = None,
        anyway: bool = False,
    ):
        options = _given(
            threads=threads, precision=precision, integrator=integrator, rule_code=rule_code, ranks=ranks, gpus=gpus,
            devices=None if devices is None else list(devices), port=port, baud=baud,
        )  # fmt: skip
        every = None if probe_every is None else _count(probe_every, "probe_every")
        self._folder = _Folder() if isinstance(start, Simulation) else None  # what it left has to last: programs and pages read it
        begin = _left_by(start, self._folder.name if self._folder else "")
        tables = _tables(Scene, scene)
        with sources(tables, arch) as source:
            self._of = _cuboct.Simulation(source.at(stage or "", begin), engine or "", options, every, bool(anyway))
        constraints = tables.get("constraint", [])
        self._keys = {one.get("name"): f"constraint[{k}].velocity" for k, one in enumerate(constraints)}

    def step(self, steps: int = 1) -> None:
        """Goes so many steps further. RunError where one cannot be done; the state before it stands."""
        self._of.step(_count(steps, "steps"))

    def run(self) -> None:
        """Goes to the scene's last step, or to where its `until` holds."""
        self._of.run()

    @property
    def engine(self) -> str:
        """Its name."""
        return self._of.engine

    @property
    def steps(self) -> int:
        """Steps done."""
        return self._of.step_count()

    @property
    def dt(self) -> float:
        """Time step, s."""
        return self._of.dt

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self.steps * self.dt

    @property
    def particles(self) -> int:
        """Their number."""
        return self._of.particles

    @property
    def positions(self) -> NDArray[np.float64]:
        """(particles, 3), m. A copy."""
        return self._of.state()["positions"]

    @property
    def velocities(self) -> NDArray[np.float64]:
        """(particles, 3), m/s. A copy. They live half a step before the positions; with velocity Verlet at the same time."""
        return self._of.state()["velocities"]

    @property
    def types(self) -> NDArray[np.uint8]:
        """(particles,), indices into `type_names`. A copy."""
        return self._of.state()["types"]

    @property
    def type_names(self) -> list[str]:
        """"material" or "material/constraint"."""
        return self._of.type_names

    @property
    def masses(self) -> NDArray[np.float64]:
        """(particles,), kg: of each particle's material. A copy."""
        return np.asarray(self._of.type_masses)[self.types]

    @property
    def hash(self) -> str | None:
        """Of the state, 16 hexadecimal digits: equal in all engines of the fixed rule. None of real numbers."""
        return self._of.hash()

    @property
    def plan_hash(self) -> str:
        """Of the machine."""
        return self._of.plan_hash()

    @property
    def energies(self) -> dict[str, float]:
        """`kinetic`, `potential`, `gravity` and `total`, J, at the time of the positions."""
        return self._of.energies()[0]

    @property
    def temperature(self) -> float | None:
        """K, in reduced units J; None where the scene has none (docs/reference/trace.md, Temperature)."""
        return self._of.energies()[1]

    @property
    def fields(self) -> dict[str, NDArray[np.float64]]:
        """What a rule of the scene shows of each particle, (particles,) or of vectors (particles, 3). `damage`, where bonds break: 0 to 1. A copy."""
        return self._of.fields()

    @property
    def curves(self) -> dict[str, NDArray[Any]]:
        """What probes and energies read so far: "step", "time" (s), then the curves by name, such as "tension.stress".

        Units: `units`. Curves of energies are called energy.kinetic and so on. They are read every `probe_every` steps; where the scene says
        how often, energies, temperature and pressure have "energy.step" and "energy.time" of their own.
        """
        return self._of.curves()[0]

    @property
    def units(self) -> dict[str, str]:
        """Of `curves`, by the same names."""
        return self._of.curves()[1]

    def set_velocity(self, constraint: str, velocity: Sequence[float]) -> None:
        """Imposes another velocity, three numbers in m/s, on what the constraint of this name holds or moves.

        The state stays as it is, to the last bit; cells are reached from where particles are now. InputError where the formats of the
        machine's numbers, which were chosen for the scene, cannot hold it; nothing is changed then.
        """
        with self._changing(self._keys.get(constraint)):
            self._of.set_velocity(constraint, _vector(velocity, "a velocity"))

    def set_gravity(self, gravity: Sequence[float]) -> None:
        """Another gravity, three numbers in m/s^2. As `set_velocity`."""
        with self._changing("gravity"):
            self._of.set_gravity(_vector(gravity, "gravity"))

    @contextmanager
    def _changing(self, key: str | None) -> Iterator[None]:
        try:
            yield
        except InputError as error:
            error.key = key
            raise

    def picture(self, field: str = "strain", *, limit: float | None = None, width: int = 1200) -> bytes:
        """A PNG of the present state, by gnuplot: `field` is "strain", "speed", "thickness" or "broken" (bonds).

        `limit`: where the colours end (strain: 0.01 is 1 %; m/s; m), None: at the 90th percentile. `width`: pixels, 400 to 16384.
        """
        if limit is not None and not 0 < limit < float("inf"):
            raise InputError(f"limit = {limit!r}: a number above 0")
        if not 400 <= _count(width, "width") <= 16384:
            raise InputError(f"width = {width}: from 400 to 16384 pixels")
        return self._of.picture(field, limit or 0.0, width)

    def view(self, *, particles: int | None = None, limit: int = 20, height: int = 900) -> View:
        """The present state in 3D, with the curves so far: a notebook shows it at the end of a cell (docs/user/view.md).

        `particles`: at most so many are shown, spread over the ids. `limit`: MB that the page may have. `height`: pixels. After a
        change of velocity or gravity places and velocities are doubles, without their bits.
        """
        return _view(self._of.shown(), None, particles, limit, height)

    def _repr_png_(self) -> bytes:
        return self.picture()

    def __repr__(self) -> str:
        title = self._of.title or "a scene"
        return f"<cuboct.Simulation of {title}: {self.particles} particles, step {self.steps}, {self.engine} engine>"
