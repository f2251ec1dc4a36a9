"""The simple shear that a scene imposes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .box import Floats


@dataclass(frozen=True)
class Shear:
    """A simple shear: velocity along ``flow`` grows along an axis.

    Attributes:
        flow: Direction of the flow, a unit vector.
        gradient: Number of the axis along which its velocity grows.
        rate: Growth of the velocity per length, positive; not a number where it changes with time or a stress decides it (column ``shear_rate`` of the series).
    """

    flow: Floats
    gradient: int
    rate: float

    @property
    def steady(self) -> bool:
        """Whether the rate is the same at all times."""
        return self.rate == self.rate


def shear_of(scene: dict[str, Any]) -> Shear | None:
    """The shear of a scene: that of its drive, or of walls across one axis that slide past each other; ``None`` for others, and dry ones."""
    flow = scene.get("flow", {})
    if flow.get("model") in ("none", "scalar"):
        return None
    domain = scene["domain"]
    dimension = len(domain["size"])
    drive = flow.get("drive", {})
    if isinstance(rate := drive.get("shear_rate"), (dict, list)) or "shear_stress" in drive:
        return Shear(np.eye(dimension)[0], 1, float("nan"))
    if rate:
        return Shear(np.sign(rate) * np.eye(dimension)[0], 1, abs(float(rate)))
    kinds = [domain.get(axis, "periodic") for axis in "xyz"[:dimension]]
    walled = [axis for axis, kind in enumerate(kinds) if kind != "periodic"]
    if len(walled) != 1 or not isinstance(kinds[walled[0]], dict):
        return None
    [gradient] = walled
    still = [0.0] * dimension
    difference = np.subtract(kinds[gradient].get("upper", still), kinds[gradient].get("lower", still))
    speed = float(np.linalg.norm(difference))
    return Shear(difference / speed, gradient, speed / domain["size"][gradient]) if speed else None
