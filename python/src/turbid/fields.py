"""The fluid in a frame."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from .box import Floats
from .files import read_hdf5


class Fields(Mapping[str, Floats]):
    """Values at the centres of the cells of a frame, each read when it is asked for.

    ``velocity`` and ``pressure``, ``inside`` (the part of a cell that lies in bodies) and, where the scene asks for it, ``vorticity``. The axes
    of arrays are those of the grid, the slowest first: ``(y, x)`` or ``(z, y, x)``, and last the component of a vector. The program computes on
    a staggered grid; it writes velocities interpolated to the centres.

    Attributes:
        coordinates: Places of the centres along ``x``, ``y`` and ``z``.
        spacing: Lengths of a cell along x, y and z.
        dimensions: Names of the axes of a scalar: ``("y", "x")``.
    """

    def __init__(self, path: Path, names: list[str], cells: list[int], spacing: Floats) -> None:
        self._path = path
        self._names = names
        self._read: dict[str, Floats] = {}
        self.spacing = spacing
        axes = "xyz"[: len(cells)]
        self.coordinates = {axis: (np.arange(count) + 0.5) * length for axis, count, length in zip(axes, cells, spacing)}
        self.dimensions = tuple(reversed(axes))

    def __getitem__(self, name: str) -> Floats:
        if name not in self._names:
            raise KeyError(f"{name}; {self._path} holds {', '.join(self._names)}")
        if name not in self._read:
            self._read[name] = read_hdf5(self._path, lambda file: trimmed(np.asarray(file["fields"][name]), len(self.coordinates)))
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        cells = " x ".join(str(len(places)) for places in self.coordinates.values())
        return f"<fields {', '.join(self._names)} on {cells} cells>"


def trimmed(stored: Floats, dimension: int) -> Floats:
    """A field as the file has it, in space, without what 2D fills up."""
    if dimension == 3:
        return stored
    flat = stored[0]
    return flat[..., :2] if flat.ndim == 3 else flat
