# SPDX-License-Identifier: MIT
"""What is measured of the frames of a run: radial distribution, displacement, coordination, common neighbours, stress."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _cuboct
from ._errors import InputError

Frames = Optional[Union[str, Sequence[int]]]
Size = Optional[Union[str, float]]


class Measured(dict[str, NDArray[Any]]):
    """The columns of a table by name, as `cuboct measure` writes them. `pandas.DataFrame` takes it."""

    units: dict[str, str]  # of the columns, and of "particles"
    notes: dict[str, str]  # how it was measured
    particles: NDArray[Any] | None  # with particles=True: (frames, particles), of displacements (..., 3), of stress times volume (..., 6)

    def __init__(self, found: tuple[dict[str, NDArray[Any]], dict[str, str], dict[str, str], NDArray[Any] | None]):
        super().__init__(found[0])
        self.units, self.notes, self.particles = found[1:]


def _options(**given: Any) -> dict[str, Any]:
    for name in ("com", "virial", "particles"):
        given[name] = True if given[name] else None
    options = {name: value for name, value in given.items() if value is not None}
    for name in ("cutoff", "volume"):
        if name in options and not isinstance(options[name], str):
            options[name] = float(options[name])
    for name in ("bins", "threads"):
        if name in options and (not isinstance(options[name], (int, np.integer)) or not 0 <= options[name] < 2**31):
            raise InputError(f"{name} is a whole number, not {options[name]!r}")
    if isinstance(options.get("types"), str):
        options["types"] = [options["types"]]
    elif "types" in options:
        options["types"] = list(options["types"])
    return options


def _frames(frames: Frames) -> str:
    if frames is None or isinstance(frames, str):
        return frames or ""
    if len(frames) == 0:
        raise InputError("frames is an empty list: it names no step")
    return ",".join(str(int(step)) for step in frames)


def measure(
    directory: str | os.PathLike[str],
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
    """What `cuboct measure DIRECTORY WHAT` tells of the frames that `cuboct run --out` left (docs/user/measure.md).

    `what`: "rdf", "msd", "coordination", "cna" or "stress". `frames`: as the command takes them, or a list of steps. `cutoff`, `volume`: in
    SI, or a text such as "3 angstrom". `particles`: also what each particle has. The other arguments are the command's options of that name.
    `Run.measure` is the same of a run of `cuboct.run`.
    """
    options = _options(
        cutoff=cutoff, bins=bins, types=types, volume=volume, com=com, virial=virial, particles=particles, threads=threads
    )  # fmt: skip
    return Measured(_cuboct.measure(os.fspath(directory), what, _frames(frames), options))
