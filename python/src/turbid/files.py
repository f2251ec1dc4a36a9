"""Files of a run, which may change while they are read: each is read anew once it has changed."""

from __future__ import annotations

import csv
import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, TypeVar

import h5py
import pandas as pd

T = TypeVar("T")

# the program exchanges run.h5 for a longer one while it runs; who opened the old one tries again
_TRIES = 4


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
            self._value = self._read(self.path)
            self._stamp = stamp
        return self._value


def read_json(path: Path) -> dict[str, Any]:
    """The object of a JSON file."""
    value: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return value


def read_table(path: Path) -> pd.DataFrame:
    """A table of a run by its steps, indexed by time; a last row that is half written is left out."""
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    return numbers(whole or "step,time\n").set_index("time")


def numbers(text: str) -> pd.DataFrame:
    """A table of numbers as CSV, to the last digit, which some versions of pandas round; empty cells are ``nan``."""
    header, *rows = csv.reader(text.splitlines())

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
    """What a function finds in an HDF5 file, which is open no longer than it takes and locked for nobody."""
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
