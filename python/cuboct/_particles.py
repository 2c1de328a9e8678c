# SPDX-License-Identifier: MIT
"""Arrays as a file of particles, which [particles] of a scene reads."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from ._errors import InputError


def write_particles(
    path: str | os.PathLike[str],
    positions: Any,
    velocities: Any = None,
    *,
    species: str | Sequence[str] | None = None,
    box: Sequence[float] | None = None,
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    periodic: str = "xyz",
    reduced: bool = False,
) -> None:
    """Writes arrays as extended XYZ with all their digits: scene["particles"] = {"file": path} reads it.

    `positions` and `velocities` have a row for each particle, in m and m/s, of a scene in reduced units as its numbers are (`reduced`).
    `species` is a name for all or one for each. `box` is its three lengths, from `origin` on, and `periodic` the axes along which it repeats.
    """
    x = _rows(positions, "positions")
    columns, names, units = [x], "pos:R:3", "reduced" if reduced else "m"
    if velocities is not None:
        v = _rows(velocities, "velocities")
        if len(v) != len(x):
            raise InputError(f"{len(x)} positions, but {len(v)} velocities")
        columns.append(v)
        names += ":velo:R:3"
    words = [species] * len(x) if isinstance(species, str) else ["X"] * len(x) if species is None else list(species)
    if len(words) != len(x):
        raise InputError(f"{len(x)} positions, but {len(words)} species")
    for word in set(words):
        if not isinstance(word, str) or len(word.split()) != 1 or word.split()[0] != word:
            raise InputError(f"species are words without blanks, not {word!r}")
    head = ""
    if box is not None:
        if not isinstance(periodic, str) or set(periodic) - set("xyz"):
            raise InputError(f"periodic are axes of 'xyz', not {periodic!r}")
        edges, corner = _rows([box], "box")[0].tolist(), _rows([origin], "origin")[0].tolist()
        if min(edges) <= 0:
            raise InputError(f"a box has edges above 0, not {edges}")
        head = 'Lattice="{} 0 0 0 {} 0 0 0 {}" Origin="{} {} {}" '.format(*edges, *corner)
        head += 'pbc="{}" '.format(" ".join("T" if axis in periodic else "F" for axis in "xyz"))
    speed = "reduced" if reduced else "m/s"
    head += f'Properties=species:S:1:{names} units="pos:{units} velo:{speed}"'
    temporary = f"{os.fspath(path)}.{os.getpid()}.tmp"
    try:
        with open(temporary, "w", encoding="utf-8") as out:
            out.write(f"{len(x)}\n{head}\n")
            for word, row in zip(words, np.hstack(columns).tolist()):
                out.write(word + " " + " ".join(map(repr, row)) + "\n")
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)


def _rows(given: Any, what: str) -> Any:
    try:
        rows = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{what} are rows of three numbers") from None
    if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) == 0:
        raise InputError(f"{what} have the shape (particles, 3), not {rows.shape}")
    if not np.isfinite(rows).all():
        raise InputError(f"{what} hold a number that is not finite")
    return rows
