"""Runs that the tests read, made once: a few seconds together."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot
import pytest

import turbid

matplotlib.use("Agg")

WALLS: dict[str, Any] = {
    "title": "disks between sliding walls",
    "seed": 1,
    "domain": {"size": [16.0, 8.0], "y": {"lower": [-4.0, 0.0], "upper": [4.0, 0.0]}},
    "resolution": {"cells_per_radius": 4},
    "method": {"inverse": "transform"},
    "bodies": [{"radius": 1.0, "fraction": 0.3, "gap": 0.1}],
    "contact": {"model": "inelastic"},
    "time": {"end": 0.3, "step": 0.02},
    "output": {"every": 1e-3, "pairs": True, "displacements": True, "structure_factor": True, "velocity_autocorrelation": True, "vorticity": True},
}

SPHERES: dict[str, Any] = {
    "title": "spheres in a box whose images slide",
    "seed": 1,
    "domain": {"size": [5.0, 5.0, 5.0]},
    "flow": {"drive": {"shear_rate": 1.0, "periodic": "sheared"}},
    "resolution": {"cells_per_radius": 3},
    "method": {"inverse": "transform"},
    "bodies": [{"radius": 0.7, "count": 10}, {"radius": 0.5, "count": 8}],
    "contact": {"model": "inelastic"},
    "time": {"end": 0.5},
    "output": {"every": 1e-3, "pairs": True, "structure_factor": True, "velocity_autocorrelation": True},
}

CHAINS: dict[str, Any] = {
    "title": "fibres and a cell",
    "seed": 4,
    "domain": {"size": [14.0, 10.0], "y": {"lower": [-5.0, 0.0], "upper": [5.0, 0.0]}},
    "resolution": {"cells_per_radius": 3},
    "method": {"inverse": "transform"},
    "lubrication": {"model": "pairwise"},
    "chains": [{"count": 3, "beads": 5, "radius": 0.4, "spacing": 1.1, "stretch": "rigid", "bend": 20.0}],
    "cells": [{"count": 1, "beads": 24, "radius": 0.3, "stretch": "rigid", "bend": 0.0315}],
    "contact": {"model": "inelastic"},
    "time": {"end": 0.05},
    "output": {"every": 0.025},
}

DRY: dict[str, Any] = {
    "title": "dry disks that fall",
    "seed": 2,
    "gravity": [0.0, -1.0],
    "domain": {"size": [6.0, 8.0], "y": "walls"},
    "flow": {"model": "none"},
    "bodies": [{"radius": 0.3, "count": 40, "gap": 0.2}, {"radius": 0.5, "centers": [[3.0, 0.9]], "motion": "fixed"}],
    "contact": {"model": "gluey"},
    "time": {"end": 3.0},
    "output": {"every": 0.1},
}

SCALAR: dict[str, Any] = {
    "title": "conduction",
    "domain": {"size": [1.0, 1.0]},
    "flow": {"model": "scalar", "drive": {"mean_gradient": [1.0, 0.0]}},
    "resolution": {"cells_per_radius": 8},
    "bodies": [{"radius": 0.3989422804014327, "centers": [[0.513, 0.527]]}],
}

Make = Callable[..., turbid.Run]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="session")
def walls(folder: Path) -> turbid.Run:
    return turbid.run(WALLS, out=folder / "walls", ranks=2, progress=False)


@pytest.fixture(scope="session")
def spheres(folder: Path) -> turbid.Run:
    return turbid.run(SPHERES, out=folder / "spheres", ranks=2, progress=False)


@pytest.fixture(scope="session")
def chains(folder: Path) -> turbid.Run:
    return turbid.run(CHAINS, out=folder / "chains", ranks=1, progress=False)


@pytest.fixture(scope="session")
def dry(folder: Path) -> turbid.Run:
    return turbid.run(DRY, out=folder / "dry", ranks=1, progress=False)


@pytest.fixture(scope="session")
def scalar(folder: Path) -> turbid.Run:
    return turbid.run(SCALAR, out=folder / "scalar", ranks=1, progress=False)


@pytest.fixture
def unfinished(walls: turbid.Run, tmp_path: Path) -> turbid.Run:
    """A run as a kill leaves it: no summary, and half a row."""
    shutil.copytree(walls.folder, tmp_path / "unfinished")
    (tmp_path / "unfinished" / "summary.json").unlink()
    series = tmp_path / "unfinished" / "series.csv"
    series.write_text(series.read_text() + "99,0.3")
    return turbid.open(tmp_path / "unfinished")


@pytest.fixture(autouse=True)
def close_figures() -> Any:
    yield
    matplotlib.pyplot.close("all")
