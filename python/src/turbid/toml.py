"""Scenes as TOML: what Python holds becomes the text that the program reads."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from .errors import Invalid

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def document(scene: Mapping[str, Any]) -> str:
    """A scene as a TOML document, a section for each table and each entry of a list of tables."""
    plain = [(name, value) for name, value in scene.items() if not _is_section(value)]
    text = "".join(f"{_key(name)} = {inline(value)}\n" for name, value in plain)
    for name, value in scene.items():
        if isinstance(value, Mapping):
            text += _section(f"[{_key(name)}]", value)
        elif _is_section(value):
            text += "".join(_section(f"[[{_key(name)}]]", entry) for entry in value)
    return text


def inline(value: Any) -> str:
    """A value on one line: a number, a text, a list, an array or a table.

    Raises:
        Invalid: TOML has no such value.
    """
    if isinstance(value, (np.ndarray, np.generic)):
        return inline(value.tolist())
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        entries = ", ".join(f"{_key(name)} = {inline(entry)}" for name, entry in value.items())
        return f"{{ {entries} }}" if entries else "{}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(inline(entry) for entry in value) + "]"
    raise Invalid(f"{value!r} has no place in a scene: leave the key out, or give a number, a text, a list, an array or a dict")


def _is_section(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return bool(value) and all(isinstance(entry, Mapping) for entry in value)
    return isinstance(value, Mapping)


def _section(head: str, entries: Mapping[str, Any]) -> str:
    return f"\n{head}\n" + "".join(f"{_key(name)} = {inline(value)}\n" for name, value in entries.items())


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else json.dumps(name, ensure_ascii=False)
