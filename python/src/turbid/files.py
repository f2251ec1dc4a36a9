"""Files of a run, which may change while they are read: each is read anew once it has changed."""

from __future__ import annotations

import csv
import json
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Generic, TypeVar

import h5py
import pandas as pd

from .errors import Damaged

T = TypeVar("T")

# what readers raise for a file that is not what it should be
_BROKEN = (OSError, ValueError, KeyError, IndexError, TypeError, RuntimeError, StopIteration)

# the program exchanges run.h5 for a longer one while it runs; who opened the old one tries again
_TRIES = 4


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Reads a file that is there.

    Raises:
        Damaged: It is not what it should be.
    """
    try:
        yield
    except (FileNotFoundError, Damaged):
        raise
    except _BROKEN as error:
        raise Damaged(path, str(error).split("\n")[0] or type(error).__name__) from error


class Cached(Generic[T]):
    """What a file holds; nothing while there is no such file."""

    def __init__(self, path: Path, read: Callable[[Path], T]) -> None:
        self.path = path
        self._read = read
        self._stamp: tuple[int, int, int] | None = None
        self._value: T | None = None

    def get(self) -> T | None:
        """The value, read again if the file has changed."""
        try:
            found = self.path.stat()
        except OSError:
            return None
        stamp = (found.st_mtime_ns, found.st_size, found.st_ino)
        if stamp != self._stamp:
            with reading(self.path):
                self._value = self._read(self.path)
            self._stamp = stamp
        return self._value


def read_json(path: Path) -> dict[str, Any]:
    """The object of a JSON file."""
    value = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(value, dict):
        raise ValueError("it holds no object")
    return value


def read_table(path: Path) -> pd.DataFrame:
    """A table of a run by its steps, indexed by time; a last row that is half written is left out."""
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    return numbers(whole or "step,time\n").set_index("time")


def numbers(text: str) -> pd.DataFrame:
    """A table of numbers as CSV, to the last digit, which some versions of pandas round; empty cells are ``nan``."""
    header, *rows = csv.reader(text.splitlines())
    for number, row in enumerate(rows, start=2):
        if len(row) != len(header):
            raise ValueError(f"line {number} has {len(row)} cells under {len(header)} heads")

    def column(cells: tuple[str, ...]) -> list[int] | list[float]:
        try:
            return [int(cell) for cell in cells]
        except ValueError:
            return [float(cell) if cell.strip() else math.nan for cell in cells]

    columns = map(column, zip(*rows, strict=True)) if rows else [[] for _ in header]
    return pd.DataFrame(dict(zip(header, columns)), columns=header)


def last_row(path: Path) -> dict[str, float] | None:
    """The last whole row of a table, without its empty cells."""
    try:
        with path.open("rb") as file:
            header = file.readline().decode().strip().split(",")
            size = file.seek(0, 2)
            file.seek(max(size - 4 * 1024, 0))
            lines = file.read().split(b"\n")
    except OSError:
        return None
    cells = lines[-2].decode(errors="replace").split(",") if len(lines) > 1 else []
    if len(cells) != len(header) or cells == header:
        return None
    try:
        return {name: float(cell) for name, cell in zip(header, cells) if cell}
    except ValueError:
        return None


def read_hdf5(path: Path, read: Callable[[h5py.File], T]) -> T:
    """What a function finds in an HDF5 file, which is open no longer than it takes and locked for nobody.

    Raises:
        FileNotFoundError: There is none.
        Damaged: It cannot be read, or lacks what it should hold.
    """
    with reading(path):
        return _read_hdf5(path, read)


def _read_hdf5(path: Path, read: Callable[[h5py.File], T]) -> T:
    for left in reversed(range(_TRIES)):
        try:
            # who has it open in this process may have locked it
            with h5py.File(path, "r", locking=None if left % 2 == 0 else False) as file:
                return read(file)
        except (OSError, KeyError, RuntimeError):
            if left == 0 or not path.exists():
                raise
            time.sleep(0.02)
    raise AssertionError("a file is read or an error is raised")
