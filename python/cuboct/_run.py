# SPDX-License-Identifier: MIT
"""Whole runs in any engine, comparisons of engines, and studies."""
from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _cuboct
from ._errors import InputError, RunError
from ._measure import Frames, Measured, Size, _frames, _options
from ._scene import ArchLike, SceneLike, sources
from ._simulation import Start, _count, _Folder, _given, _left_by
from ._view import View, _view


@dataclass(frozen=True)
class Frame:
    """A state of a run, by particle id."""

    step: int
    positions: NDArray[np.float64]  # (particles, 3), m
    velocities: NDArray[np.float64]  # (particles, 3), m/s, half a step before the positions
    types: NDArray[np.uint8]  # (particles,)
    fields: dict[str, NDArray[np.float64]] = field(default_factory=dict)  # what the scene's [rule] shows, by name: (particles,) or (particles, 3)


@dataclass(frozen=True)
class Run:
    """What a run leaves."""

    engine: str
    steps: int  # done
    dt: float  # s
    seconds: float  # of host time, of the steps alone
    hash: str | None  # of the last state, 16 hexadecimal digits; None of real numbers
    hashes: NDArray[np.uint64]  # at steps 0, hash_every, 2 hash_every, ..., and the last
    hash_every: int
    plan_hash: str
    curves: dict[str, NDArray[Any]]  # "step", "time" (s), probes by name; "energy.step", "energy.time", energies, temperature, pressure
    units: dict[str, str]  # of the curves
    frames: list[Frame]
    cycles: NDArray[np.uint64] | None  # [step, node, phase, (first, last)], of engines that count them
    counters: dict[str, float]
    warnings: list[str]  # what the watch found wrong (docs/reference/failures.md)
    stopped: str | None  # why it could not go on to its last step
    reached: str | None  # where the scene's `until` ended it
    summary: dict[str, Any]  # of `cuboct run --json`
    stages: dict[str, Run] = field(default_factory=dict)  # of a scene of stages the runs of all, by name; this is the last
    _matter: Any = field(default=None, repr=False, compare=False)
    _shown: Any = field(default=None, repr=False, compare=False)
    _folder: Any = field(default=None, repr=False, compare=False)  # with the state that it began with, for as long as it lives

    @property
    def positions(self) -> NDArray[np.float64]:
        """Of the last state, (particles, 3), m."""
        return self.frames[-1].positions

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Of the last state, (particles, 3), m/s, half a step before the positions."""
        return self.frames[-1].velocities

    @property
    def fields(self) -> dict[str, NDArray[np.float64]]:
        """Of the last state what the scene's [rule] shows, by name: (particles,), of vectors (particles, 3)."""
        return self.frames[-1].fields

    def table(self) -> dict[str, NDArray[Any]]:
        """`curves` with one row for each step at which any of them has a sample, and NaN where one has none: "step", "time" (s), curves.

        `pandas.DataFrame(run.table())` takes it. With static loading steps are load steps, and "time" means nothing.
        """
        late = False  # behind "energy.step" curves are those of its steps
        steps = {False: self.curves["step"], True: self.curves.get("energy.step", self.curves["step"])}
        every = np.union1d(steps[False], steps[True])
        table = {"step": every, "time": every * self.dt}
        for name, values in self.curves.items():
            late = late or name == "energy.step"
            if name in ("step", "time", "energy.step", "energy.time"):
                continue
            table[name] = np.full(len(every), np.nan)
            table[name][np.searchsorted(every, steps[late])] = values
        return table

    def measure(
        self,
        what: str,
        *,
        frames: Frames = None,
        cutoff: Size = None,
        bins: int | None = None,
        types: str | Sequence[str] | None = None,
        volume: Size = None,
        com: bool = False,
        virial: bool = False,
        particles: bool = False,
        threads: int | None = None,
    ) -> Measured:
        """What `cuboct measure` tells of `frames` (docs/user/measure.md): "rdf", "msd", "coordination", "cna" or "stress".

        Arguments are as of `cuboct.measure`. A run keeps its last state alone unless `frame_every` says otherwise.
        """
        if self._matter is None:
            raise InputError("a run that was pickled has no scene to measure by")
        options = _options(
            cutoff=cutoff, bins=bins, types=types, volume=volume, com=com, virial=virial, particles=particles, threads=threads
        )  # fmt: skip
        kept = self.frames
        return Measured(
            self._matter.measure(
                what, _frames(frames), options,
                [frame.step for frame in kept], [frame.positions for frame in kept], [frame.velocities for frame in kept],
            )
        )  # fmt: skip

    def view(self, *, every: int | None = None, particles: int | None = None, limit: int = 20, height: int = 900) -> View:
        """The run in 3D: a notebook shows it at the end of a cell (docs/user/view.md). Its frames are those of `frames`.

        `every`: each so-manieth frame, and the last. `particles`: at most so many are shown, spread over the ids. `limit`: MB that the page
        may have. `height`: pixels.
        """
        if self._shown is None:
            raise InputError("a run that was pickled has no states to show")
        return _view(self._shown, every, particles, limit, height)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_matter": None, "_shown": None, "_folder": None}

    def __repr__(self) -> str:
        return f"<cuboct.Run of {self.steps} steps, {self.engine} engine, hash {self.hash}>"


@dataclass(frozen=True)
class Comparison:
    """How a crosscheck ended. True where all engines matched."""

    matched: bool
    text: str  # "matched U updates over S steps in K engines", or the first difference
    step: int | None  # of the first difference
    engines: tuple[str, str] | None  # that differ first
    updates: int  # of particles, that were found equal
    steps: int

    def __bool__(self) -> bool:
        return self.matched

    def __str__(self) -> str:
        return self.text


def _stages(source: Any, stage: str | None, steps: int | None) -> list[tuple[str, str]]:
    """Those to take: name of the part, and of its stage. One without names where the scene has none. All can be read."""
    names = [one for one in source.stages() if stage in (None, *one)]
    if len(names) > 1 and steps is not None:
        raise InputError("steps goes with stage: each stage has its own steps")
    for name, _ in names:
        source.at(name, "").read()
    return names or [(stage or "", "")]


def run(
    scene: SceneLike,
    engine: str | None = None,
    *,
    stage: str | None = None,
    start: Start = None,
    arch: ArchLike = None,
    steps: int | None = None,
    frame_every: int | None = None,
    threads: int | None = None,
    ranks: int | None = None,
    precision: str | None = None,
    integrator: str | None = None,
    rule_code: str | None = None,
    hash_every: int | None = None,
    cycles: bool = False,
    gpus: int | None = None,
    devices: Sequence[int] | None = None,
    port: str | None = None,
    baud: int | None = None,
    anyway: bool = False,
) -> Run:
    """Runs a scene from its start, as `cuboct run` does, in any engine: lattice, golden, reference, systemc, rtl, gpu or fpga.

    `engine`: None for the one that the scene asks for, as the command takes it: reference for a `[rule]` and for static loading, else lattice.
    A scene of stages runs one after the other, and all are in `stages` of what is returned; `stage` takes one. `start`: a `Simulation`, or the
    directory of `cuboct run --out`, whose last state it begins with. `steps`: None for the scene's. `frame_every`: keeps every so many states,
    0 the first and the last; None: the last alone. The other arguments are the command's options of that name. RunError where a step cannot
    be done, with what there is in its `run`.
    """
    options = _given(
        threads=threads, ranks=ranks, precision=precision, integrator=integrator, rule_code=rule_code, hash_every=hash_every,
        gpus=gpus, devices=None if devices is None else list(devices), port=port, baud=baud,
    )  # fmt: skip
    options["cycles"] = bool(cycles)
    last = None if steps is None else _count(steps, "steps")
    every = None if frame_every is None else _count(frame_every, "frame_every")
    runs: dict[str, Run] = {}
    kept = _Folder()
    folder = kept.name
    with sources(scene, arch) as source:
        begin = _left_by(start, folder)
        names = _stages(source, stage, last)
        ended = None  # a stage whose `until` held in an earlier part
        for k, (name, whole) in enumerate(names):
            if ended is not None and whole == ended:
                continue
            leave = os.path.join(folder, str(k)) if k + 1 < len(names) else ""
            found = _cuboct.run(source.at(name, begin), engine or "", options, last, every, bool(anyway), leave)
            found["frames"] = [Frame(**frame) for frame in found["frames"]]
            found["summary"] = json.loads(found["summary"])
            result = runs[name] = Run(**found, stages=runs if name else {}, _folder=kept if begin else None)
            if result.stopped is not None:
                error = RunError(result.stopped, result.summary.get("advice", {}).get("value", ""), result.steps)
                error.run = result
                raise error
            begin = leave
            ended = whole if result.reached is not None else None
    return result


def crosscheck(
    scene: SceneLike,
    engines: Sequence[str] = ("golden", "lattice"),
    *,
    stage: str | None = None,
    start: Start = None,
    arch: ArchLike = None,
    steps: int | None = None,
    threads: int | None = None,
    rule_code: str | None = None,
) -> Comparison:
    """Runs a scene in several engines of the fixed rule and compares every bit, and every cycle where two engines count them.

    A scene of stages is compared stage by stage, each from the state in which all engines ended the one before. The other
    arguments are as of `run`.

    >>> assert crosscheck("scenes/lj_block.toml", ["golden", "lattice"], steps=5)
    """
    last = None if steps is None else _count(steps, "steps")
    if isinstance(engines, str):
        raise InputError(f"engines is a list of names, not {engines!r}", 'engines=["golden", "lattice"]')
    total = Comparison(True, "", None, None, 0, 0)
    with sources(scene, arch) as source, tempfile.TemporaryDirectory() as folder:
        begin = _left_by(start, folder)
        names = _stages(source, stage, last)
        ended = None
        for k, (name, whole) in enumerate(names):
            if ended is not None and whole == ended:
                continue
            leave = os.path.join(folder, str(k)) if k + 1 < len(names) else ""
            found = _cuboct.crosscheck(source.at(name, begin), list(engines), _given(threads=threads, rule_code=rule_code), last, leave)
            reached, stopped = found.pop("reached"), found.pop("stopped")
            one = Comparison(**found)
            text = f"stage {name}\n{one.text}" if len(names) > 1 else one.text
            total = Comparison(
                one.matched, f"{total.text}\n{text}" if total.text else text, one.step, one.engines,
                total.updates + one.updates, total.steps + one.steps,
            )  # fmt: skip
            if stopped or not one:
                break
            begin = leave
            ended = whole if reached else None
    return total


def explore(
    study: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    speed: bool = True,
) -> dict[str, Any]:
    """Runs a study (docs/user/study.md) and returns its points as a table: columns by name, one entry per point.

    Texts are lists, numbers NumPy arrays with nan for what was not measured: settings by their keys, `status`, `dt` (s), the study's figures by
    name in SI, `error.*` against the truth, `cost`, speeds. pandas.DataFrame takes it as it is. What was computed stays in the directory `out`
    (None: that of the study's name with .study) and is not computed again. `speed=False` leaves speeds out.
    """
    name = os.fspath(study)
    where = os.fspath(out) if out is not None else Path(name).stem + ".study"
    count = 0 if jobs is None else _count(jobs, "jobs")
    columns, left_out = _cuboct.explore(name, where, count, bool(speed))
    if left_out:
        warnings.warn(left_out, stacklevel=2)
    return {name: _numbers(column) for name, column in columns.items()}


def _numbers(column: Any) -> Any:
    """Settings that are all numbers, as such."""
    try:
        return np.array([float(value) for value in column])
    except ValueError:
        return column
