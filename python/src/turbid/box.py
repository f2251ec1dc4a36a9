"""The box of a run: periodic images, also where they slide past each other."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Box:
    """A box at one time, from the origin to ``size``.

    Attributes:
        size: Its lengths.
        periodic: Which axes are periodic; the others end at walls or openings.
        offset: By how much the box above lies to the right, along x; ``None`` where images do not slide.
        offset_rate: The rate of that.
    """

    size: Floats
    periodic: tuple[bool, ...]
    offset: float | None = None
    offset_rate: float = 0.0

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.size)

    @property
    def volume(self) -> float:
        """Its area or volume."""
        return float(np.prod(self.size))

    def boxes_along(self, axis: int) -> Floats:
        """From the origin of the box to that of the next one along an axis."""
        step = np.zeros(self.dimension)
        step[axis] = self.size[axis]
        if axis == 1 and self.offset is not None:
            step[0] = self.offset
        return step

    def wrap(self, points: Floats) -> Floats:
        """The images of points that lie in the box."""
        points = np.array(points, dtype=float)
        for axis in self._order():
            rows = np.floor(points[..., axis] / self.size[axis])
            points -= rows[..., None] * self.boxes_along(axis)
            # what rounding leaves on the far side
            points[..., axis] = np.where(points[..., axis] >= self.size[axis], 0.0, points[..., axis])
        return points

    def nearest(self, separations: Floats) -> Floats:
        """The shortest of all periodic images of separations."""
        separations = np.asarray(separations, dtype=float)
        if not (self.offset is not None and self.periodic[1]):
            return self._rounded(separations)
        row = np.round(separations[..., 1] / self.size[1])
        tried = [self._rounded(separations - (row + more)[..., None] * self.boxes_along(1), skip=1) for more in (-1, 0, 1)]
        lengths = np.stack([(image**2).sum(-1) for image in tried])
        best: Floats = np.take_along_axis(np.stack(tried), lengths.argmin(0)[None, ..., None], 0)[0]
        return best

    def images(self, points: Floats, reach: float) -> tuple[Integers, Floats]:
        """All periodic images of points within ``reach`` of the box, those in the box first: numbers of the points, and where they are."""
        points = self.wrap(points)
        count = len(points)
        numbers = np.arange(count)
        for axis in self._order():
            most = ceil(reach / self.size[axis])
            step = self.boxes_along(axis)
            places, of = [points], [numbers]
            for row in [row for row in range(-most, most + 1) if row]:
                moved = points + row * step
                if axis == 1 and self.offset is not None:
                    # back over the box, for the images along x to be made of
                    moved[:, 0] %= self.size[0]
                near = (moved[:, axis] >= -reach) & (moved[:, axis] <= self.size[axis] + reach)
                places.append(moved[near])
                of.append(numbers[near])
            points, numbers = np.concatenate(places), np.concatenate(of)
        return numbers, points

    def _order(self) -> list[int]:
        """Periodic axes, the one across which images slide before that along which they do."""
        return [axis for axis in (1, 0, 2) if axis < self.dimension and self.periodic[axis]]

    def _rounded(self, separations: Floats, skip: int | None = None) -> Floats:
        separations = separations.copy()
        for axis in self._order():
            if axis != skip:
                separations[..., axis] -= self.size[axis] * np.round(separations[..., axis] / self.size[axis])
        return separations
