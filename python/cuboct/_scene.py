# SPDX-License-Identifier: MIT
"""Scenes and archs: nested dicts that stand for TOML files."""
from __future__ import annotations

import copy
import os
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Self, Union

from . import _cuboct
from ._errors import InputError
from ._toml import dumps


class _Tables(dict[str, Any]):
    """A TOML file as a nested dict. As long as nothing is changed the text is that of the file, and errors point into it."""

    _what = ""  # the name in errors of one that was made here

    def __init__(self, tables: Mapping[str, Any] = {}, /, **more: Any):
        super().__init__(tables, **more)
        self._read: tuple[dict[str, Any], str, str] | None = None  # as it was read: tables, text, path
        # From where paths within count: that of the file it came from; "": the working directory.
        self._directory: str = getattr(tables, "_directory", "")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Reads a file. InputError, with its place, where it is no TOML."""
        name = os.fspath(path)
        tables = cls._of(_cuboct.read_text(name), name)
        tables._directory = os.path.dirname(os.path.abspath(name))
        return tables

    @classmethod
    def parse(cls, text: str) -> Self:
        """The same for a text."""
        return cls._of(text, cls._what)

    @classmethod
    def _of(cls, text: str, path: str) -> Self:
        text = text.removeprefix("\ufeff")
        _check_text(text, path)
        _cuboct.check_toml(text, path)
        try:
            tables = cls(tomllib.loads(text))
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise InputError(f"{path}: {error}") from None
        tables._read = (copy.deepcopy(dict(tables)), text, path)
        return tables

    def toml(self) -> str:
        """The text that engines read: the file's own, comments included, or where something was changed a new one."""
        return self._source()[0]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes `toml()` to a file, which the command `cuboct` then reads."""
        with open(path, "w", encoding="utf-8") as out:
            out.write(self.toml())

    def copy(self) -> Self:
        """A copy that shares no table with this one."""
        return copy.deepcopy(self)

    def _source(self) -> tuple[str, str, list[str] | None]:
        """Text, name in errors, and the keys by line where the text was made here."""
        if self._read and self._read[0] == self:
            return self._read[1], self._read[2], None
        text, ways = dumps(self._with_whole_paths())
        _check_text(text, self._what)
        return text, self._what, ways

    def _with_whole_paths(self) -> Mapping[str, Any]:
        """What is written here stands in no directory: paths that counted from that of a file are made whole."""
        return self


class Scene(_Tables):
    """What to simulate, as a nested dict: its tables are those of a scene file (docs/user/scene.md).

    Quantities are texts with units ("3 GPa"); lists of tables, such as scene["constraint"], are lists of dicts.

    >>> scene = Scene.like("tension")
    >>> scene["law"]["youngs_modulus"] = "4 GPa"
    """

    _what = "scene"

    def _with_whole_paths(self) -> Mapping[str, Any]:
        if not self._directory:
            return self

        def whole(name: str, value: Any) -> Any:
            if name == "file" and isinstance(value, str):
                return os.path.join(self._directory, value)
            if isinstance(value, Mapping):
                return {key: whole(key, one) for key, one in value.items()}
            if isinstance(value, (list, tuple)):
                return [whole("", one) for one in value]
            return value

        tables = {key: whole(key, value) for key, value in self.items()}
        if isinstance(tables.get("rule"), str):
            tables["rule"] = os.path.join(self._directory, tables["rule"])
        start = tables.get("start")
        if isinstance(start, dict) and isinstance(start.get("from"), str):
            start["from"] = os.path.join(self._directory, start["from"])
        return tables

    @classmethod
    def like(cls, template: str) -> Self:
        """A template of `cuboct new`: tension, impact, drop, beam, gas, metal, crack, sheet, release or rule."""
        return cls._of(_cuboct.template_text(template), template)

    def check(self, arch: "ArchLike" = None, *, stage: str | None = None) -> dict[str, Any]:
        """Reads the scene as a run would, of stages the first or `stage`. InputError where it is wrong.

        `title`; `particles`; `dt` and `dt_limit` (the largest stable one, None where unknown) in s; `steps`; `cells`; `cells_with_matter`, at
        the start; `cell_edges` along x, y and z in m, and `cell_edge`, the longest; `nodes` of the machine (`cells`, `cells_with_matter` and
        `nodes` are None of a rule with rounds of its own, for which no machine is built; `nodes` of cells that are no cubes, too);
        `plan_hash`; `reach`, what [reach] margin = "auto" tells, else None; `warnings`;
        `probes`, by name: `errors` that integers leave, a list of `quantity`, `error`, `unit` ("1": a share of the curve) and `of_means`, and a `text`;
        `engine`, which runs it where none is named; `stages`, their names.
        """
        with sources(self, arch) as source:
            return _cuboct.check(source.at(stage or "", ""))


class Arch(_Tables):
    """A machine, as a nested dict: its tables are those of an arch file (docs/user/arch.md)."""

    _what = "arch"


def _check_text(text: str, name: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        raise InputError(f"{name}: {text[error.start]!a} in line {line} is no character") from None


SceneLike = Union[Scene, Mapping[str, Any], str, "os.PathLike[str]"]
ArchLike = Union[Arch, Mapping[str, Any], str, "os.PathLike[str]", None]


def _tables(kind: type[_Tables], given: Any) -> _Tables:
    if isinstance(given, kind):
        return given
    if isinstance(given, Mapping):
        return kind(given)
    if isinstance(given, (str, os.PathLike)):
        return kind.load(given)
    raise InputError(
        f"{given!r} is no {kind._what}", f"a cuboct.{kind.__name__}, a dict, or the path of a file"
    )


@contextmanager
def sources(scene: SceneLike, arch: ArchLike = None) -> Iterator[Any]:
    """What the module reads. Errors within are told with the key of the dict that they mean."""
    text, name, ways = _tables(Scene, scene)._source()
    machine = ("", "", None) if arch is None else _tables(Arch, arch)._source()
    keys = {name: ways, machine[1]: machine[2]}
    try:
        yield _cuboct.Sources(text, name, machine[0], machine[1])
    except InputError as error:
        known = keys.get(error.file) if error.file else None
        if known and error.line and error.line <= len(known) and known[error.line - 1]:
            error.key = known[error.line - 1]
        raise
