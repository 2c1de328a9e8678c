# SPDX-License-Identifier: MIT
"""The errors of cuboct."""
from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._run import Run


class InputError(ValueError):
    """Something that was given is wrong: a scene, an arch, a study, or an argument.

    `message` and `hint` are texts; an empty hint: there is none. `file`, `line`, `column` (counted from 1) say where,
    and are None where no place is known. Of a scene or arch made of a dict, `file` is "scene" or "arch", the place counts in the
    text that its `toml()` gives, and `key` is the way there in the dict, such as "law.youngs_modulus". Of a value that a
    `Simulation` was given on its way, `key` says which one it was to replace, and there is no place.
    """

    message: str
    hint: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    key: str | None = None
    _excerpt: str = ""

    def __init__(self, message: str, hint: str = ""):
        super().__init__(message)
        self.message = message
        self.hint = hint

    def _set_place(self, place: tuple[str, int, int, str]) -> None:
        self.file, self.line, self.column, self._excerpt = place

    def __str__(self) -> str:
        text = self.message
        if self.key is not None and self.file is not None:
            text = f"{self.file}, {self.key}: {text}"
        elif self.file is not None:
            text = f"{self.file}:{self.line}:{self.column}: {text}"
        if self._excerpt:
            text += "\n" + self._excerpt
        if self.hint:
            text += "\n  hint: " + self.hint
        return text


class RunError(RuntimeError):
    """A step could not be done: a number left its width, a cell was full, a particle left the lattice.

    `step` is the last step that was done, `advice` what helps (empty: nothing is known). A `Simulation` holds the state after
    that step; `run` is what `cuboct.run` has of the run up to there, else None.
    """

    def __init__(self, message: str, advice: str = "", step: int = 0):
        super().__init__(message)
        self.advice = advice
        self.step = step
        self.run: Run | None = None

    def __str__(self) -> str:
        text = super().__str__()
        return f"{text}\n  {self.advice}" if self.advice else text
