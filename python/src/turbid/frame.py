"""A frame of a run, whose arrays are read when they are asked for."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
import numpy.typing as npt
import pandas as pd

from .box import Box, Floats
from .contacts import Bonds, Contacts, Membranes, faces_of
from .errors import Missing
from .fields import Fields
from .files import read_hdf5, reading

if TYPE_CHECKING:
    import xarray

    from .results import Run


class Frame:
    """A run at one time. Arrays are read when they are asked for, and kept as long as the frame is.

    Vectors have a column for each axis; spins and torques are single numbers in 2D, positive from x to y.
    """

    def __init__(self, run: Run, index: int, number: int) -> None:
        self.run = run
        #: Place among the frames of the run.
        self.index = index
        #: Number in the name of its file.
        self.number = number
        self.path: Path = run.folder / "frames" / f"{number:06}.h5"
        self._bodies: dict[str, npt.NDArray[Any]] = {}

    def __repr__(self) -> str:
        return f"<frame {self.index} of {self.run.name}: time {self.time:g}, {len(self)} bodies>"

    def __len__(self) -> int:
        """Number of bodies."""
        return int(self._attributes["body_count"])

    @cached_property
    def _attributes(self) -> dict[str, Any]:
        def read(file: h5py.File) -> dict[str, Any]:
            kept = {name: file.attrs[name] for name in file.attrs}
            return kept | {"groups": {name: list(group) for name, group in file.items()}}

        try:
            return read_hdf5(self.path, read)
        except FileNotFoundError:
            raise Missing(f"{self.path} is listed in run.h5 but not there") from None

    @property
    def time(self) -> float:
        """Its time."""
        with reading(self.path):
            return float(self._attributes["time"])

    @property
    def step(self) -> int:
        """Number of time steps so far."""
        return int(self._attributes["step"])

    @property
    def strain(self) -> float | None:
        """The strain at its time, where the flow is a simple shear."""
        return self.run.strain_at(self.time)

    @cached_property
    def box(self) -> Box:
        """The box, with periodic images where they are at this time."""
        found = self._attributes
        with reading(self.path):
            offset = float(found["offset"]) if "offset" in found else None
            periodic = tuple(bool(axis) for axis in found["periodic"])
            return Box(np.array(found["size"], dtype=float), periodic, offset, float(found.get("offset_rate", 0.0)))

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.box.dimension

    @property
    def ids(self) -> npt.NDArray[np.int32]:
        """Numbers of the bodies, in the order of all arrays."""
        return self._body("id")

    @property
    def centres(self) -> Floats:
        """Centres in the box, a row each; :meth:`unwrapped` has them as they were followed."""
        return self._body("center")[:, : self.dimension]

    @property
    def radii(self) -> Floats:
        """Radii."""
        return self._body("radius")

    @property
    def velocities(self) -> Floats:
        """Velocities of the centres; where images slide, those of the images in the box."""
        return self._body("velocity")[:, : self.dimension]

    @property
    def spins(self) -> Floats:
        """Angular velocities."""
        return self._turns("spin")

    @property
    def rotations(self) -> Floats:
        """Rotation matrices since the start, shape ``(bodies, dimension, dimension)``."""
        return self._body("rotation").reshape(-1, 3, 3)[:, : self.dimension, : self.dimension]

    @property
    def forces(self) -> Floats:
        """Forces of the fluid on the bodies."""
        return self._body("force")[:, : self.dimension]

    @property
    def torques(self) -> Floats:
        """Torques of the fluid on the bodies."""
        return self._turns("torque")

    @property
    def touches(self) -> npt.NDArray[np.int32]:
        """Number of contacts of each body that bear a force."""
        return self._body("contacts")

    @property
    def bodies(self) -> pd.DataFrame:
        """All bodies as a table, a row each, without rotations."""
        columns: dict[str, npt.NDArray[Any]] = {}
        for name, vectors in (("", self.centres), ("velocity_", self.velocities), ("force_", self.forces)):
            columns |= {f"{name}{axis}": component for axis, component in zip("xyz", vectors.T)}
        for name, turns in (("spin", self.spins), ("torque", self.torques)):
            flat = turns.ndim == 1
            columns |= {name: turns} if flat else {f"{name}_{axis}": part for axis, part in zip("xyz", turns.T)}
        table = pd.DataFrame({"radius": self.radii, "contacts": self.touches, **columns}, index=pd.Index(self.ids, name="body"))
        return table

    @cached_property
    def contacts(self) -> Contacts:
        """The contacts that bear a force or stick; none without a law of contact."""
        found, dimension = self._group("contacts"), self.dimension
        if not found:
            whole, real = np.zeros(0, dtype=np.int32), np.zeros(0)
            vectors = np.zeros((0, dimension))
            return Contacts(whole, whole, vectors.astype(np.int32), vectors, vectors, real, real)
        point, normal, image = (found[name][:, :dimension] for name in ("point", "normal", "image"))
        friction = found["friction"][:, :dimension] if "friction" in found else None
        return Contacts(found["body"], found["partner"], image, point, normal, found["gap"], found["force"], found.get("gamma"), friction)

    @cached_property
    def bonds(self) -> Bonds:
        """The bonds of chains, cells and clusters; none in a scene without them."""
        found = self._group("bonds")
        if not found:
            return Bonds(np.zeros((0, 2), dtype=np.int32), np.zeros((0, 2, self.dimension)), np.zeros(0, dtype=np.int32))
        points = found["point"][:, : self.dimension].reshape(-1, 2, self.dimension)
        return Bonds(found["body"].reshape(-1, 2), points, found["chain"].reshape(-1, 2)[:, 0])

    @cached_property
    def membranes(self) -> Membranes:
        """The membranes of cells; none in a scene without them."""
        found = self._group("membranes")
        if not found:
            none = np.zeros(0, dtype=np.int32)
            return Membranes(none, np.zeros((0, self.dimension)), none, [])
        return Membranes(found["body"], found["point"][:, : self.dimension], found["chain"], faces_of(self._group("faces")["topology"]))

    @property
    def has_fields(self) -> bool:
        """Whether the flow is in this frame."""
        return "fields" in self._attributes["groups"]

    @cached_property
    def fields(self) -> Fields:
        """The flow, at the centres of cells.

        Raises:
            Missing: The frame has none.
        """
        if not self.has_fields:
            raise Missing(f"{self.path} holds no fields: the scene is dry, or has output.fields = false")
        found = self._attributes
        cells = [int(count) for count in found["cells"]]
        return Fields(self.path, sorted(found["groups"]["fields"]), cells, np.array(found["spacing"], dtype=float))

    def unwrapped(self) -> Floats:
        """Centres as they were followed from the first frame on, through sides of the box; reads all frames before this one."""
        from .trajectories import followed

        places: Floats = np.zeros((0, self.dimension))
        for places, _ in followed(self.run.frames[: self.index + 1]):
            pass
        return places

    def to_xarray(self) -> xarray.Dataset:
        """Bodies and fields as a ``Dataset`` with coordinates; needs xarray."""
        from .arrays import frame_dataset

        return frame_dataset(self)

    def _body(self, name: str) -> npt.NDArray[Any]:
        if not self._bodies:
            self._bodies = self._group("bodies")
        with reading(self.path):
            return self._bodies[name]

    def _turns(self, name: str) -> Floats:
        turns = self._body(name)
        return turns if self.dimension == 3 else turns[:, 2]

    def _group(self, name: str) -> dict[str, npt.NDArray[Any]]:
        if name not in self._attributes["groups"]:
            return {}
        return read_hdf5(self.path, lambda file: {entry: np.asarray(values) for entry, values in file[name].items()})
