"""The frames of a run, which are read when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, overload

import h5py
import numpy as np
import numpy.typing as npt

from .box import Floats
from .errors import Invalid, Missing, OutOfRange
from .files import read_hdf5
from .frame import Frame

if TYPE_CHECKING:
    from .results import Run


class Frames(Sequence[Frame]):
    """Frames of a run in the order of time; taking one, or a slice, reads nothing yet."""

    def __init__(self, run: Run, numbers: npt.NDArray[np.int64], times: Floats, first: int = 0, step: int = 1) -> None:
        self._run = run
        self._numbers = numbers
        self._first = first
        self._step = step
        #: Times of the frames.
        self.times = times

    def __len__(self) -> int:
        return len(self._numbers)

    @overload
    def __getitem__(self, place: int) -> Frame: ...

    @overload
    def __getitem__(self, place: slice) -> Frames: ...

    def __getitem__(self, place: int | slice) -> Frame | Frames:
        if isinstance(place, slice):
            start, _, step = place.indices(len(self))
            return Frames(self._run, self._numbers[place], self.times[place], self._first + start * self._step, self._step * step)
        if not -len(self) <= place < len(self):
            raise OutOfRange(f"frame {place} of {len(self)}: {self._run.folder} has frames 0 to {len(self) - 1}" if len(self) else _none(self._run))
        place %= len(self)
        return Frame(self._run, self._first + place * self._step, int(self._numbers[place]))

    def __iter__(self) -> Iterator[Frame]:
        return (self[place] for place in range(len(self)))

    def at(self, time: float) -> Frame:
        """The frame whose time is nearest."""
        if not len(self):
            raise Missing(_none(self._run))
        if not isinstance(time, (int, float, np.integer, np.floating)) or not np.isfinite(time):
            raise Invalid(f"time = {time!r}: must be a number")
        return self[int(np.abs(self.times - time).argmin())]

    def since(self, time: float) -> Frames:
        """The frames from a time on."""
        return self[int(np.searchsorted(self.times, time * (1 - 1e-12))) :]

    def __repr__(self) -> str:
        span = f", times {self.times[0]:g} to {self.times[-1]:g}" if len(self) else ""
        return f"<{len(self)} frames of {self._run.name}{span}>"


def _none(run: Run) -> str:
    return f"{run.folder} has no frames: only runs in time write them, every output.every"


def list_frames(path: Path) -> tuple[npt.NDArray[np.int64], Floats]:
    """Numbers and times of the frames that ``run.h5`` lists."""

    def read(file: h5py.File) -> tuple[npt.NDArray[np.int64], Floats]:
        numbers = np.array(sorted(int(name) for name in file["frames"]), dtype=np.int64)
        times = np.asarray(file["times"], dtype=float)
        count = min(len(numbers), len(times))
        return numbers[:count], times[:count]

    return read_hdf5(path, read)
