"""What ties bodies in a frame: contacts, bonds, membranes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from .box import Floats

Counts = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Contacts:
    """The contacts of a frame, a row each.

    Attributes:
        body: Numbers of the bodies.
        partner: Numbers of what they touch; walls are -1, -2, .. (lower x, upper x, lower y, ..).
        image: Boxes between the partner's centre, as it was followed from the start, and the image of it that is touched.
        point: Points half way between the surfaces, in the box.
        normal: Unit vectors from the body to the partner.
        gap: Distances between the surfaces.
        force: Forces between them, positive where they push.
        gamma: Memories of contacts, where they are gluey.
        friction: Forces of friction on the partners, across the normals, where contacts have friction.
    """

    body: Counts
    partner: Counts
    image: Counts
    point: Floats
    normal: Floats
    gap: Floats
    force: Floats
    gamma: Floats | None = None
    friction: Floats | None = None

    def __len__(self) -> int:
        return len(self.body)

    @property
    def table(self) -> pd.DataFrame:
        """All of it as a table."""
        columns: dict[str, npt.NDArray[np.generic]] = {"body": self.body, "partner": self.partner, "gap": self.gap, "force": self.force}
        vectors_of: dict[str, npt.NDArray[np.generic]] = {"point": self.point, "normal": self.normal, "image": self.image}
        if self.friction is not None:
            vectors_of["friction"] = self.friction
        for name, vectors in vectors_of.items():
            columns |= {f"{name}_{axis}": component for axis, component in zip("xyz", vectors.T)}
        if self.gamma is not None:
            columns["gamma"] = self.gamma
        return pd.DataFrame(columns)


@dataclass(frozen=True)
class Bonds:
    """The bonds of chains, cells and clusters in a frame, a row each.

    Attributes:
        bodies: Numbers of the two bodies.
        points: Where these are: the first in the box, the second the image that the bond leads to.
        chain: Number of the chain, cell or cluster.
    """

    bodies: Counts
    points: Floats
    chain: Counts

    def __len__(self) -> int:
        return len(self.bodies)


@dataclass(frozen=True)
class Membranes:
    """The membranes of cells in a frame.

    Attributes:
        body: Numbers of the bodies that are corners.
        point: Where they are; some corners of a membrane that crosses a side of the box lie outside.
        chain: Number of the cell of each corner.
        faces: For each face, polygons in 2D and triangles in 3D, the places of its corners among these.
    """

    body: Counts
    point: Floats
    chain: Counts
    faces: list[npt.NDArray[np.int64]]

    def __len__(self) -> int:
        return len(self.faces)


_POLYGON = 3


def faces_of(topology: npt.NDArray[np.integer]) -> list[npt.NDArray[np.int64]]:
    """The faces in a list as XDMF has it: kind, number of corners where it is a polygon, and corners."""
    entries, faces, place = topology.astype(np.int64), [], 0
    while place < len(entries):
        start, count = (place + 2, int(entries[place + 1])) if entries[place] == _POLYGON else (place + 1, 3)
        faces.append(entries[start : start + count])
        place = start + count
    return faces
