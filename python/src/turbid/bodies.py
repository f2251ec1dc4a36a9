"""The bodies of a summary as a table."""

from __future__ import annotations

from typing import Any

import pandas as pd


def table_of(bodies: list[dict[str, Any]]) -> pd.DataFrame:
    """A row for each body, a column for each component."""
    rows = [{name: part for key, value in body.items() for name, part in _flat(key, value)} for body in bodies]
    return pd.DataFrame(rows, index=pd.RangeIndex(len(rows), name="body"))


def _flat(key: str, value: Any) -> list[tuple[str, float]]:
    """Columns of an entry of a body in a summary."""
    if not isinstance(value, list):
        return [(key, value)]
    if key == "center":
        return list(zip("xyz", value))
    if key == "stresslet":
        axes = "xyz"[: len(value)]
        return [(f"{key}_{one}_{two}", value[row][column]) for row, one in enumerate(axes) for column, two in enumerate(axes)]
    if len(value) == 1:
        return [(key, value[0])]
    return [(f"{key}_{axis}", part) for axis, part in zip("xyz", value)]
