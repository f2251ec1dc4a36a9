"""Frames and fields as xarray's data sets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .box import Floats
from .errors import Missing

if TYPE_CHECKING:
    import xarray

    from .fields import Fields
    from .frame import Frame
    from .frames import Frames
    from .results import Run

try:
    import xarray as xr
    from xarray.backends import BackendArray
    from xarray.core import indexing
except ImportError as error:
    raise ImportError("data sets take xarray: pip install 'turbid[xarray]'") from error


def frame_dataset(frame: Frame) -> xarray.Dataset:
    """Bodies by ``body`` and ``axis``, fields by ``y`` and ``x``, and the time."""
    axes = list("xyz"[: frame.dimension])
    vectors = {"centre": frame.centres, "body_velocity": frame.velocities, "force": frame.forces}
    turns = {"spin": frame.spins, "torque": frame.torques}
    turned = ("body",) if frame.dimension == 2 else ("body", "axis")
    data: dict[str, Any] = {name: (("body", "axis"), values) for name, values in vectors.items()}
    data |= {name: (turned, values) for name, values in turns.items()}
    data |= {"radius": ("body", frame.radii), "rotation": (("body", "axis", "turned_axis"), frame.rotations)}
    coordinates: dict[str, Any] = {"body": frame.ids, "axis": axes, "turned_axis": axes, "time": frame.time}
    if frame.has_fields:
        fields = frame.fields
        coordinates |= fields.coordinates
        data |= {name: (_dimensions(fields, fields[name]), fields[name]) for name in fields}
    attributes: dict[str, Any] = {"units": "those of the scene", "size": frame.box.size, "periodic": [int(axis) for axis in frame.box.periodic]}
    if frame.box.offset is not None:
        attributes |= {"offset": frame.box.offset, "offset_rate": frame.box.offset_rate}
    return xr.Dataset(data, coordinates, attributes)


def fields_dataset(run: Run) -> xarray.Dataset:
    """The fields of all frames that hold the same ones; what is selected is read."""
    frames = run.frames
    if not len(frames) or not frames[-1].has_fields:
        raise Missing(f"{run.folder} has no frames with fields: the scene is dry, or has output.fields = false")
    fields = frames[-1].fields
    data = {name: (("time", *_dimensions(fields, fields[name])), indexing.LazilyIndexedArray(_Over(frames, name, fields[name]))) for name in fields}
    coordinates: dict[str, Any] = {**fields.coordinates, "time": frames.times, "axis": list("xyz"[: len(fields.coordinates)])}
    strain = run.strain_at(frames.times)
    if strain is not None:
        coordinates["strain"] = ("time", strain)
    return xr.Dataset(data, coordinates, {"units": "those of the scene"})


def _dimensions(fields: Fields, values: Floats) -> tuple[str, ...]:
    extra = values.ndim - len(fields.dimensions)
    return fields.dimensions + (("axis",) if extra else ())


class _Over(BackendArray):
    """A field over the times of frames."""

    def __init__(self, frames: Frames, name: str, example: npt.NDArray[np.float64]) -> None:
        self.frames = frames
        self.name = name
        self.shape = (len(frames), *example.shape)
        self.dtype = example.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._read)

    def _read(self, key: tuple[Any, ...]) -> npt.NDArray[np.float64]:
        places, rest = key[0], key[1:]
        if isinstance(places, (int, np.integer)):
            return _outer(self.frames[int(places)].fields[self.name], rest)
        chosen = np.arange(len(self.frames))[places]
        rows = [_outer(self.frames[int(place)].fields[self.name], rest) for place in chosen]
        whole = np.empty((0, *self.shape[1:]))
        return np.stack(rows) if rows else whole[(slice(None), *rest)]


def _outer(values: Floats, key: tuple[Any, ...]) -> Floats:
    """Picks along each axis for itself."""
    for axis, chosen in reversed(list(enumerate(key))):
        values = values[(slice(None),) * axis + (chosen,)]
    return values
