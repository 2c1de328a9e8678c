# SPDX-License-Identifier: MIT
"""A run as a page in 3D, in a notebook or a file."""
from __future__ import annotations

import html
import os
from dataclasses import dataclass, field
from typing import Any

from ._errors import InputError


@dataclass(frozen=True)
class View:
    """The page of `cuboct view --save`. A notebook shows it at the end of a cell."""

    html: str = field(repr=False)
    height: int  # pixels, in a notebook

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes it as one file, which a browser opens without a server."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.html)

    def _repr_html_(self) -> str:
        # A frame without an origin of its own: the page reaches neither the notebook nor a network.
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" sandbox="allow-scripts allow-downloads"'
            f' style="width: 100%; height: {self.height}px; border: 0"></iframe>'
        )


def _whole(value: Any, what: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or value < 1:
        raise InputError(f"{what} is a whole number from 1 on, not {value!r}")
    return value


def _view(shown: Any, every: int | None, particles: int | None, limit: int, height: int) -> View:
    words = ["--limit", str(_whole(limit, "limit"))]
    for option, value in (("every", every), ("particles", particles)):
        if value is not None:
            words += [f"--{option}", str(_whole(value, option))]
    return View(shown.page(words), _whole(height, "height"))
