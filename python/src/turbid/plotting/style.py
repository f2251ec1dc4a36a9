"""Colours and words of plots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib.pyplot as plt

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Colours that the colour-blind tell apart (Okabe & Ito 2008).
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]

BODY = "#c8cdd3"
DARK = "#4a4f55"
EDGE = "#3a3f45"
FORCE = "#D55E00"
BOND = "#222222"
WALL = "#555555"

#: Of numbers from small to large, and of those around 0.
GROWING = "viridis"
AROUND_ZERO = "PuOr"

_UNITS = "[units of the scene]"
_LABELS = {
    "time": f"time {_UNITS}",
    "strain": "strain",
    "step": "step",
    "last_step": f"length of the step {_UNITS}",
    "viscosity": "relative viscosity",
    "viscosity_from_walls": "relative viscosity, from the walls",
    "first_normal_difference": "first normal stress difference / (viscosity × rate)",
    "second_normal_difference": "second normal stress difference / (viscosity × rate)",
    "particle_pressure": "pressure that bodies bear / (viscosity × rate)",
    "contacts": "contacts that bear a force",
    "smallest_gap": "smallest gap [radii]",
    "kkt_residual": "residual of the contacts",
    "iterations": "iterations in the step",
    "solves": "solves in the step",
    "seconds": "wall time of the step [s]",
    "reynolds": "Reynolds number",
    "stokes": "Stokes number",
    "courant": "Courant number",
    "momentum_residual": "momentum residual",
    "boundary_layer": "thinnest boundary layer [cells]",
    "fraction": "volume fraction",
    "inside": "volume fraction",
    "area_error": "error of the area, relative",
    "volume_error": "error of the volume, relative",
    "inclination": "inclination [rad]",
}
_NORMAL_STRESSES = ("first_normal_difference", "second_normal_difference", "particle_pressure")
_PLAIN = ("orientation", "chain_orientation", "drag", "lift")


def label(name: str) -> str:
    """What an axis of a quantity is called, with its unit."""
    if name in _LABELS:
        return _LABELS[name]
    words = name.replace("_", " ")
    for whole in _NORMAL_STRESSES:
        if name.startswith(f"{whole}_"):
            return f"{_LABELS[whole]}, part of {name.removeprefix(f'{whole}_')}"
    if name.startswith("viscosity_"):
        return f"relative viscosity, part of {words.removeprefix('viscosity ')}"
    return words if name.startswith(_PLAIN) else f"{words} {_UNITS}"


def axes_of(axes: Axes | None, size: tuple[float, float] = (6.4, 4.0)) -> Axes:
    """The axes that are given, or new ones."""
    if axes is not None:
        return axes
    _, new = plt.subplots(figsize=size, layout="constrained")
    return new


def finish(axes: Axes) -> Axes:
    """The looks that charts share."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.margins(x=0)
    return axes
