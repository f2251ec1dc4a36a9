"""Sweeps: quantities of a scene against keys of it that are varied, as tables."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from .arguments import keys, whole
from .errors import Invalid, Missing
from .executable import PathLike, command, environment
from .files import read_json, reading
from .launch import Overrides, SceneLike, overrides_of, scene_file
from .process import Program
from .toml import inline

_KEEP = ("series", "all", "nothing")


def sweep(
    scene: SceneLike,
    vary: Mapping[str, Sequence[Any]],
    *,
    quantity: str | Sequence[str] | None = None,
    seeds: int = 1,
    set: Overrides = None,
    ranks: int = 1,
    out: PathLike | None = None,
    keep: str = "series",
    fresh: bool = False,
    progress: bool = True,
    executable: PathLike | None = None,
    launcher: str | None = None,
) -> pd.DataFrame:
    """Runs a scene with all combinations of values of some keys by ``turbid sweep``, and returns a table with a row for each.

    A sweep that was interrupted goes on where it stopped, also with more values or seeds.

    Args:
        scene: A scene file, or a scene as a ``dict``, as :func:`run` takes it.
        vary: The keys with the values of each: ``{"bodies.0.fraction": [0.1, 0.2, 0.3]}``.
        quantity: What is read from each run, one or several: ``"viscosity"``, ``"drag"``, ``"settling"``, a column as ``"series.contacts"``, that at the
            end as ``"last.contacts"``, or a key of ``summary.json`` as ``"flow.mean_velocity.0"``. Without it, what the scene is about.
        seeds: Runs of each combination, whose scatter gives the interval.
        set: Other keys that replace those of the scene in all runs.
        ranks: Ranks of each run.
        out: Output folder; ``out/NAME-sweep`` of the scene if it is not given.
        keep: What is kept of each run: ``"series"`` (its summary, series and scene), ``"all"`` or ``"nothing"``.
        fresh: Forget what was measured before.
        progress: Show each run as it ends.
        executable: The program, as :func:`run` takes it.
        launcher: What starts several ranks, ``"mpirun -n {ranks}"`` if it is not given.

    Returns:
        The table, as :func:`open_sweep` reads it.

    Raises:
        Invalid: An argument of this function cannot be used.
        Refused: The program refuses the scene, a key, a quantity or the folder, or no run came to its end.
    """
    if keep not in _KEEP:
        raise Invalid(f"keep = {keep!r}: must be one of {', '.join(_KEEP)}")
    words = [*_varied(vary), *_quantities(quantity), *overrides_of(set), "--seeds", str(whole("seeds", seeds)), "--ranks", str(whole("ranks", ranks))]
    words += ["--keep", keep, *(["--fresh"] if fresh else []), *([] if launcher is None else ["--launcher", launcher])]
    with scene_file(scene) as (path, name):
        folder = Path(out) if out is not None else Path("out") / f"{name}-sweep"
        started = command(["sweep", str(path), *words, "--out", str(folder)], 1, executable, None)
        Program(started, environment(ranks), path if isinstance(scene, Mapping) else None, whole_group=True).watch(None, progress)
    return open_sweep(folder)


def open_sweep(folder: PathLike, runs: bool = False) -> pd.DataFrame:
    """The table of a sweep that is in a folder.

    A row for each combination: the varied keys, ``fraction_placed`` (the part of the box that bodies fill), for each quantity ``NAME`` its mean,
    ``NAME.standard_error``, ``NAME.low`` and ``NAME.high`` (the 95 % interval), ``NAME.over`` (which part of the runs the mean is over) and
    ``NAME.steady`` (how many runs have become steady), and ``runs``, ``failed``, ``seconds``.

    Args:
        folder: The folder.
        runs: A row for each run instead: the keys, ``seed``, ``fraction_placed``, each quantity with ``NAME.over``, ``seconds``, ``folder`` (what
            :func:`open` takes, where it was kept), and ``failed``, why there is none.

    Raises:
        Missing: The folder holds no sweep.
        Damaged: Its files cannot be read.
    """
    folder = Path(folder)
    name = "sweep.json" if runs else "sweep.csv"
    if not (folder / name).is_file():
        raise Missing(f"{folder} holds no {name}; turbid.sweep(.., out={str(folder)!r}) makes it")
    with reading(folder / name):
        table = _runs(folder) if runs else _points(folder / name)
    table.attrs["folder"] = str(folder)
    return table


def _points(path: Path) -> pd.DataFrame:
    header, *rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    return pd.DataFrame({head: _column(cells) for head, cells in zip(header, zip(*rows, strict=True), strict=True)})


def _runs(folder: Path) -> pd.DataFrame:
    whole_sweep = read_json(folder / "sweep.json")
    names = whole_sweep["identity"]["quantities"]
    rows = []
    for record in whole_sweep["records"]:
        row: dict[str, Any] = dict(record["setting"]["point"])
        row["seed"] = record["setting"]["seed"]
        measured = record["outcome"].get("measured")
        row["fraction_placed"] = measured and measured["fraction"]
        for place, name in enumerate(names):
            row[name] = measured and measured["readings"][place]["value"]
            row[f"{name}.over"] = measured and measured["readings"][place]["over"]
        row["seconds"] = measured and measured["seconds"]
        row["folder"] = str(folder / measured["folder"]) if measured and measured["folder"] else None
        row["failed"] = record["outcome"].get("failed")
        rows.append(row)
    table = pd.DataFrame(rows)
    keys_of_points = [key for key, _ in whole_sweep["records"][0]["setting"]["point"]] if rows else []
    return table.assign(**{key: _column(tuple(table[key])) for key in keys_of_points})


def _column(cells: tuple[str, ...]) -> list[Any]:
    """Whole numbers, numbers, or texts without the quotes of a scene file."""
    for kind in (int, lambda cell: float(cell or "nan")):
        try:
            return [kind(cell) for cell in cells]
        except ValueError:
            pass
    return [cell.strip("\"'") for cell in cells]


def _varied(vary: Mapping[str, Sequence[Any]]) -> list[str]:
    example = '{"bodies.0.fraction": [0.1, 0.2]}'
    words = []
    for key, values in keys("vary", vary, example).items():
        if isinstance(values, (str, bytes, Mapping)) or not hasattr(values, "__iter__"):
            raise Invalid(f"vary: {key} = {values!r}: must be a list of values, as vary={example}")
        words += ["--vary", f"{key}={','.join(inline(value) for value in values)}"]
    if not words:
        raise Invalid(f"vary: names no key; give one with its values, as vary={example}")
    return words


def _quantities(quantity: str | Sequence[str] | None) -> list[str]:
    if quantity is None:
        return []
    names = [quantity] if isinstance(quantity, str) else list(quantity)
    if not names or not all(isinstance(name, str) and name for name in names):
        raise Invalid(f"quantity = {quantity!r}: must be a name or a list of names, as quantity=['viscosity', 'series.contacts']")
    return ["--quantity", ",".join(names)]
