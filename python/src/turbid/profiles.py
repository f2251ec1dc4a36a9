"""Profiles across an axis: means over the other axes and over frames, with standard errors."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from . import arguments
from .box import Floats
from .errors import Invalid, Missing
from .statistics import standard_error

if TYPE_CHECKING:
    from .frame import Frame

#: What can be averaged: ``velocity`` of fluid and bodies together, ``fraction`` of the volume that bodies take, ``body_velocity`` and ``spin``
#: of what is inside bodies, and ``pressure``, ``vorticity`` and ``inside`` of the fields.
QUANTITIES = ("velocity", "fraction", "body_velocity", "spin", "pressure", "vorticity", "inside")

_OF_BODIES = ("fraction", "body_velocity", "spin")
_BINS = 40


@dataclass(frozen=True)
class Profile:
    """Means over frames across an axis.

    Attributes:
        quantity: What was averaged.
        axis: ``x``, ``y`` or ``z``.
        edges: Edges of the bins along it.
        mean: A row for each bin: a number, or a vector with a column for each axis; ``nan`` where nothing is to be averaged.
        error: Standard errors of the means over frames, by blocking; ``nan`` for a single frame.
        frames: Number of frames.
        times: Times of the first and the last of them.
    """

    quantity: str
    axis: str
    edges: Floats
    mean: Floats
    error: Floats
    frames: int
    times: tuple[float, float]

    @property
    def positions(self) -> Floats:
        """Middles of the bins."""
        middles: Floats = 0.5 * (self.edges[1:] + self.edges[:-1])
        return middles

    @property
    def names(self) -> list[str]:
        """Names of the columns of :attr:`table`."""
        return [self.quantity] if self.mean.ndim == 1 else [f"{self.quantity}_{axis}" for axis in "xyz"[: self.mean.shape[1]]]

    @property
    def table(self) -> pd.DataFrame:
        """Means and errors by position."""
        columns = zip(self.names, self.mean.reshape(len(self.mean), -1).T, self.error.reshape(len(self.error), -1).T)
        return pd.DataFrame({key: values for name, mean, error in columns for key, values in ((name, mean), (f"{name}_error", error))},
                            index=pd.Index(self.positions, name=self.axis))  # fmt: skip


def profile(frames: Iterable[Frame], quantity: str, axis: str = "y", bins: int | None = None) -> Profile:
    """The profile of a quantity across an axis over frames, which are read one at a time.

    Fields are averaged over cells; ``fraction``, ``body_velocity`` and ``spin`` over the parts of bodies that lie in a bin, which is exact.

    Args:
        frames: The frames.
        quantity: One of :data:`QUANTITIES`.
        axis: ``x``, ``y`` or ``z``.
        bins: Number of bins, without it as many as cells, or 40 where there are no fields.
    """
    if quantity not in QUANTITIES:
        raise Invalid(f"quantity = {quantity!r}: must be one of {', '.join(QUANTITIES)}")
    bins = None if bins is None else arguments.whole("bins", bins)
    samples, times, edges = [], [], np.zeros(0)
    for frame in frames:
        place = _axis(axis, frame.dimension)
        count = bins or (len(frame.fields.coordinates[axis]) if frame.has_fields else _BINS)
        edges = np.linspace(0.0, frame.box.size[place], count + 1)
        samples.append(_of_bodies(frame, quantity, place, edges) if quantity in _OF_BODIES else _of_fields(frame, quantity, axis, edges))
        times.append(frame.time)
    if not samples:
        raise Missing("there are no frames to average over")
    whole = np.array(samples)
    known = np.isfinite(whole).all(0)
    mean = np.full(known.shape, np.nan)
    filled = np.isfinite(whole).any(0)
    mean[filled] = np.nanmean(whole[:, filled], axis=0)
    error = np.where(known, standard_error(np.where(np.isfinite(whole), whole, 0.0)), np.nan)
    return Profile(quantity, axis, edges, mean, error, len(samples), (times[0], times[-1]))


def _axis(axis: str, dimension: int) -> int:
    axes = "xyz"[:dimension]
    if axis not in tuple(axes):
        raise Invalid(f"axis = {axis!r}: must be one of {', '.join(axes)}")
    return axes.index(axis)


def _of_fields(frame: Frame, quantity: str, axis: str, edges: Floats) -> Floats:
    fields = frame.fields
    if quantity not in fields:
        raise Missing(f"{frame.path} holds no {quantity}, but {', '.join(fields)}; vorticity takes output.vorticity = true")
    along = fields.dimensions.index(axis)
    values = fields[quantity]
    others = tuple(place for place in range(len(fields.dimensions)) if place != along)
    cells = values.mean(axis=others)
    # shares of cells in bins
    count = len(cells)
    bounds = np.linspace(0.0, edges[-1], count + 1)
    overlap = np.minimum(edges[1:, None], bounds[None, 1:]) - np.maximum(edges[:-1, None], bounds[None, :-1])
    weights = np.maximum(overlap, 0.0)
    binned: Floats = np.tensordot(weights / weights.sum(1, keepdims=True), cells, axes=1)
    return binned


def _of_bodies(frame: Frame, quantity: str, axis: int, edges: Floats) -> Floats:
    box, radii, centres = frame.box, frame.radii, frame.centres
    shifts = np.array([-1, 0, 1]) if box.periodic[axis] else np.array([0])
    volumes = np.zeros((len(centres), len(edges) - 1))
    moments = np.zeros_like(volumes)
    rows = np.zeros_like(volumes)
    for shift in shifts:
        volume, moment = _slices(edges[None, :] - centres[:, axis, None] - shift * box.size[axis], radii[:, None], box.dimension)
        volumes += volume
        moments += moment
        rows += shift * volume
    whole = box.volume / box.size[axis] * np.diff(edges)
    if quantity == "fraction":
        return volumes.sum(0) / whole
    filled = volumes.sum(0)
    with np.errstate(invalid="ignore", divide="ignore"):
        if quantity == "spin":
            spins: Floats = np.tensordot(volumes, frame.spins, axes=(0, 0))
            return (spins.T / filled).T
        momentum = volumes.T @ frame.velocities + moments.T @ _turning(frame.spins, axis, box.dimension)
        if axis == 1:
            # an image above moves faster by the rate at which images slide
            momentum[:, 0] += box.offset_rate * rows.sum(0)
        return momentum / filled[:, None]


def _slices(bounds: Floats, radius: Floats, dimension: int) -> tuple[Floats, Floats]:
    """Volume of disks or spheres between bounds measured from their centres, and its first moment."""
    x = np.clip(bounds, -radius, radius)
    root = np.sqrt(np.maximum(radius**2 - x**2, 0.0))
    if dimension == 2:
        volume = x * root + radius**2 * np.arcsin(x / radius)
        moment = -2 / 3 * root**3
    else:
        volume = np.pi * (radius**2 * x - x**3 / 3)
        moment = -np.pi / 4 * root**4
    return np.diff(volume, axis=1), np.diff(moment, axis=1)


def _turning(spins: Floats, axis: int, dimension: int) -> Floats:
    """Velocity relative to the centre, a unit length along the axis away from it."""
    if dimension == 2:
        return np.stack([-spins, 0 * spins] if axis == 1 else [0 * spins, spins], axis=1)
    return np.cross(spins, np.eye(3)[axis])
