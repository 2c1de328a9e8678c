# SPDX-License-Identifier: MIT
"""A nested dict as TOML text, and which line of it holds which key."""
from __future__ import annotations

import json
import numbers
import re
from collections.abc import Mapping
from typing import Any

from ._errors import InputError


def dumps(tables: Mapping[str, Any]) -> tuple[str, list[str]]:
    """The text, and for each of its lines the way to what stands there ("" for a blank line)."""
    lines: list[str] = []
    ways: list[str] = []

    def put(line: str, way: str) -> None:
        lines.append(line)
        ways.append(way)

    def put_table(head: str, table: Mapping[str, Any], way: str) -> None:
        if lines:
            put("", "")
        put(head, way)
        for name, value in table.items():
            put(f"{_key(name, way)} = {_value(value, f'{way}.{name}')}", f"{way}.{name}")

    for name, value in tables.items():  # before any table, to whom they would belong else
        if not isinstance(value, Mapping) and not _is_tables(value):
            put(f"{_key(name, '')} = {_value(value, name)}", name)
    for name, value in tables.items():
        if isinstance(value, Mapping):
            put_table(f"[{_key(name, '')}]", value, name)
        elif _is_tables(value):
            for k, table in enumerate(value):
                put_table(f"[[{_key(name, '')}]]", table, f"{name}[{k}]")
    return "\n".join(lines) + "\n", ways


def _is_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(isinstance(one, Mapping) for one in value)


def _key(name: Any, way: str) -> str:
    if not isinstance(name, str):
        raise InputError(f"a key is a text, not {name!r}", f"in {way}" if way else "")
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any, way: str) -> str:
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k, way)} = {_value(v, f'{way}.{k}')}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(one, f"{way}[{k}]") for k, one in enumerate(value)) + "]"
    raise InputError(
        f"{way} is of type {type(value).__name__}", "a text, a number, True or False, or a list or dict of these"
    )
