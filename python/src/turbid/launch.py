"""Starts the program and turns what it says into results and exceptions."""

from __future__ import annotations

import os
import re
import tempfile
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .arguments import keys
from .errors import Invalid
from .executable import PathLike, command, environment
from .process import Program, ShownProgress
from .progress import Watcher
from .results import Run
from .toml import document, inline

SceneLike = PathLike | Mapping[str, Any]
Overrides = Mapping[str, Any] | None

_TABLES = ("bodies", "chains", "cells", "clusters")


def run(
    scene: SceneLike,
    *,
    set: Overrides = None,
    ranks: int = 2,
    out: PathLike | None = None,
    force: bool = False,
    progress: ShownProgress = True,
    executable: PathLike | None = None,
    launcher: str | None = None,
) -> Run:
    """Simulates a scene and returns its run.

    Args:
        scene: A scene file, or a scene as a ``dict`` with the keys of one; arrays may stand for lists, and relative names of files in it are those
            seen from the working directory.
        set: Keys that replace those of the scene: ``{"time.end": 2.0, "bodies.0.fraction": 0.2}``.
        ranks: Number of MPI ranks; 1 starts the program without ``mpirun``.
        out: Output folder; ``out/NAME`` of the scene file if it is not given. A ``dict`` is named by its title.
        force: Write over what an earlier run has left in the folder; without it a run that is there is refused, also where a cell of a notebook
            is executed again.
        progress: Show how far the run has come, or a function that is called with a :class:`Progress` now and then, or ``False``.
        executable: The program, if it is neither named by the variable ``TURBID`` nor on the ``PATH`` nor built in this repository.
        launcher: What starts several ranks, ``"mpirun -n {ranks}"`` if it is not given.

    Raises:
        Invalid: An argument of this function cannot be used.
        Refused: The program refuses the scene, an override or the folder.
        Failed: The program ended with another error.
        KeyboardInterrupt: It was interrupted; the run has written a checkpoint, and :func:`resume` goes on with it.
    """
    with scene_file(scene) as (path, name):
        folder = Path(out) if out is not None else Path("out") / name
        words = ["run", str(path), *overrides_of(set), "--out", str(folder), *(["--force"] if force else [])]
        watcher = Watcher(folder, _end_of(path, set))
        started = Program(command(words, ranks, executable, launcher), environment(ranks), path if isinstance(scene, Mapping) else None, folder)
        printed = started.watch(watcher, progress)
    return Run(folder, printed=printed)


def resume(
    folder: PathLike,
    *,
    set: Overrides = None,
    ranks: int = 2,
    progress: ShownProgress = True,
    executable: PathLike | None = None,
    launcher: str | None = None,
) -> Run:
    """Goes on with a run from its last checkpoint; ``set`` may change ``time.end``, ``time.until`` and ``output``. Otherwise as :func:`run`."""
    folder = Path(folder)
    words = ["resume", str(folder), *overrides_of(set)]
    watcher = Watcher(folder, _end_of(folder / "scene.toml", set))
    started = Program(command(words, ranks, executable, launcher), environment(ranks), None, folder)
    return Run(folder, printed=started.watch(watcher, progress))


@dataclass(frozen=True)
class Plan:
    """What a run would build and what it would cost.

    Attributes:
        built: What is built, by its name, with what the program says of it.
        not_built: Names of what is not built.
        costs: ``grid``, ``unknowns``, ``memory`` and ``time``, as the program tells them.
        text: The whole text.
    """

    text: str
    built: dict[str, str] = field(repr=False)
    not_built: list[str] = field(repr=False)
    costs: dict[str, str] = field(repr=False)

    def __str__(self) -> str:
        return self.text

    @staticmethod
    def of(text: str) -> Plan:
        """The plan that the program has printed."""
        lines = [found.groups() for found in re.finditer(r"^(built|not built|\w+)  *(.*)$", text, re.MULTILINE)]
        pairs = [rest.partition(": ")[::2] for kind, rest in lines if kind == "built"]
        costs = {kind: rest for kind, rest in lines if kind not in ("built", "not built")}
        return Plan(text, dict(pairs), [rest for kind, rest in lines if kind == "not built"], costs)


def plan(scene: SceneLike, *, set: Overrides = None, ranks: int = 1, executable: PathLike | None = None, launcher: str | None = None) -> Plan:
    """What :func:`run` would build for a scene, with unknowns, memory and seconds; solves no more than a sample."""
    with scene_file(scene) as (path, _):
        words = ["plan", str(path), *overrides_of(set)]
        started = Program(command(words, ranks, executable, launcher), environment(ranks), path if isinstance(scene, Mapping) else None)
        return Plan.of(started.watch(None, False))


def call(words: list[str], executable: PathLike | None) -> str:
    """What the program prints when it is called on one rank with these words."""
    return Program(command(words, 1, executable, None), environment(1), None).watch(None, False)


def overrides_of(overrides: Overrides) -> list[str]:
    """The words that set keys of a scene."""
    given = keys("set", overrides, '{"time.end": 2.0}')
    return [word for key, value in given.items() for word in ("--set", f"{key}={inline(value)}")]


@contextmanager
def scene_file(scene: SceneLike) -> Iterator[tuple[Path, str]]:
    """The file of a scene and the name of its output folder."""
    if not isinstance(scene, Mapping):
        if not isinstance(scene, (str, os.PathLike)):
            raise Invalid(f"scene = {scene!r}: must be the path of a scene file, or a dict with the keys of one")
        path = Path(scene)
        yield path, path.stem
        return
    name = re.sub(r"[^a-z0-9]+", "-", str(scene.get("title", "")).lower()).strip("-")[:60] or "scene"
    with tempfile.TemporaryDirectory(prefix="turbid-") as folder:
        path = Path(folder) / f"{name}.toml"
        path.write_text(document(_with_whole_paths(scene)), encoding="utf-8")
        yield path, name


def _with_whole_paths(scene: Mapping[str, Any]) -> dict[str, Any]:
    """The scene with tables of bodies named from the root."""

    def whole(group: Any) -> Any:
        if isinstance(group, Mapping) and isinstance(group.get("file"), (str, Path)):
            return {**group, "file": str(Path(group["file"]).absolute())}
        return group

    groups = {name: [whole(group) for group in scene[name]] for name in _TABLES if isinstance(scene.get(name), (list, tuple))}
    return {**scene, **groups}


def _end_of(path: Path, overrides: Overrides) -> float:
    """The time at which a run ends, or 0 where nobody knows."""
    try:
        scene = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return 0.0
    section = scene.get("time")
    end = (overrides or {}).get("time.end", section.get("end") if isinstance(section, dict) else None)
    return float(end) if isinstance(end, (int, float)) else 0.0
