"""Arguments that cannot be used are refused with their name, their value and what would be right."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from .box import Floats
from .errors import Invalid


def whole(name: str, value: Any, least: int = 1) -> int:
    """A whole number that is at least so large."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise Invalid(f"{name} = {value!r}: must be a whole number, as {name}={max(least, 2)}")
    if value < least:
        raise Invalid(f"{name} = {value}: must be at least {least}")
    return int(value)


def above(name: str, value: Any, bound: float = 0.0) -> float:
    """A finite number above a bound."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise Invalid(f"{name} = {value!r}: must be a number above {bound:g}")
    if not (math.isfinite(value) and value > bound):
        raise Invalid(f"{name} = {value}: must be above {bound:g}")
    return float(value)


def keys(name: str, value: Any, example: str) -> Mapping[str, Any]:
    """A ``dict`` by keys of a scene; an empty one for ``None``."""
    if value is None:
        return {}
    if not isinstance(value, Mapping) or not all(isinstance(key, str) and key for key in value):
        raise Invalid(f"{name} = {value!r}: must be a dict of keys of the scene with their values, as {name}={example}")
    return value


def samples(name: str, value: npt.ArrayLike) -> Floats:
    """A list of numbers."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise Invalid(f"{name}: must be a list or an array of numbers, not {type(value).__name__}") from None
    if array.ndim != 1:
        raise Invalid(f"{name}: must be a list of numbers, not an array of shape {array.shape}; give one column")
    return array


def curve(abscissas: npt.ArrayLike, values: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Abscissas that go on in one direction, and a value for each."""
    x, y = samples("abscissas", abscissas), samples("values", values)
    if len(x) != len(y):
        raise Invalid(f"abscissas and values: are {len(x)} and {len(y)} numbers; give a value for each abscissa, as two columns of one series")
    steps = np.diff(x)
    if not (np.isfinite(x).all() and ((steps > 0).all() or (steps < 0).all())):
        raise Invalid("abscissas: must be numbers that grow from each to the next, as time and strain do")
    return x, y
