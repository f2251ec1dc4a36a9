"""A run: what is in its folder."""

from __future__ import annotations

import tomllib
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import pairs as counting
from . import profiles as averaging
from .animation import Animation
from .arguments import above, whole
from .bodies import table_of
from .box import Floats
from .errors import Missing
from .executable import PathLike
from .files import Cached, numbers, read_json, read_table, reading
from .frames import Frames, list_frames
from .pairs import PairDistribution
from .profiles import Profile
from .report import html_of
from .shear import Shear, shear_of
from .statistics import LEAST_STRAIN, Mean, shortage, steady_mean
from .viscosity import Viscosity

if TYPE_CHECKING:
    import xarray

    from .plotting import Plots

T = TypeVar("T")

# what a folder of a run has, one of them at least
_SIGNS = ("summary.json", "run.h5", "series.csv", "checkpoint.h5")
_START_UP = 0.5


class Run:
    """A run, finished or under way; each property has what is in the folder at the time when it is asked for.

    Attributes:
        folder: Its output folder.
        printed: What the program printed at the end, if this run was started from here.
    """

    def __init__(self, folder: PathLike, printed: str | None = None) -> None:
        self.folder = Path(folder)
        self.printed = printed
        if not self.folder.is_dir():
            raise Missing(f"{self.folder} is no folder; turbid.open takes the output folder of a run")
        if not any((self.folder / name).exists() for name in _SIGNS):
            raise Missing(f"{self.folder} is no run: it has none of {', '.join(_SIGNS)}")
        self._summary = Cached(self.folder / "summary.json", read_json)
        self._scene = Cached(self.folder / "scene.toml", lambda path: tomllib.loads(path.read_text(encoding="utf-8")))
        self._series = Cached(self.folder / "series.csv", read_table)
        self._forces = Cached(self.folder / "forces.csv", read_table)
        self._energy = Cached(self.folder / "energy.csv", read_table)
        self._objects = {name: Cached(self.folder / f"{name}s.csv", read_table) for name in ("chain", "cell", "cluster")}
        self._displacements = Cached(self.folder / "displacements.csv", lambda path: numbers(path.read_text(encoding="utf-8")))
        self._structure_factor = Cached(self.folder / "structure-factor.csv", lambda path: numbers(path.read_text(encoding="utf-8")))
        self._autocorrelation = Cached(self.folder / "velocity-autocorrelation.csv", lambda path: numbers(path.read_text(encoding="utf-8")))
        self._pairs = Cached(self.folder / "pairs.json", lambda path: PairDistribution.of_program(read_json(path)))
        self._frames = Cached(self.folder / "run.h5", list_frames)

    def __repr__(self) -> str:
        return f"<run {self.folder}: {self.state}>"

    def _repr_html_(self) -> str:
        return html_of(self)

    @property
    def name(self) -> str:
        """Name of its folder."""
        return self.folder.resolve().name

    @property
    def finished(self) -> bool:
        """Whether it is complete: a run under way, or one that was stopped, has no summary."""
        return (self.folder / "summary.json").exists()

    @property
    def state(self) -> str:
        """In words: how far it has come."""
        times = self._times()
        reached = f" at time {times[-1]:g}" if len(times) else ""
        return ("finished" if self.finished else "not finished") + reached

    @property
    def summary(self) -> dict[str, Any]:
        """``summary.json``: the last instant, and what it cost.

        Raises:
            Missing: The run has not finished.
        """
        found = self._summary.get()
        if found is None:
            raise Missing(
                f"{self.folder} has no summary.json: the run has not finished; turbid.resume({str(self.folder)!r}) goes on with one that was stopped"
            )
        return found

    @property
    def scene(self) -> dict[str, Any]:
        """``scene.toml``: the scene with its overrides."""
        return self._needed(self._scene.get(), "scene.toml")

    @property
    def series(self) -> pd.DataFrame:
        """``series.csv``: a row for each step, indexed by time."""
        return self._needed(self._series.get(), "series.csv: only runs in time have one").copy()

    @property
    def forces(self) -> pd.DataFrame:
        """``forces.csv``: force and torque of the fluid on each body with prescribed motion, a row for each step, indexed by time."""
        return self._needed(self._forces.get(), "forces.csv: it takes a run in time in which the motion of 1 to 16 bodies is given").copy()

    @property
    def energy(self) -> pd.DataFrame:
        """``energy.csv``: the balance of energy of a flow with inertia, a row for each step, indexed by time."""
        return self._needed(self._energy.get(), "energy.csv: it takes a flow with inertia and output.energy = true").copy()

    @property
    def chains(self) -> pd.DataFrame:
        """``chains.csv``: centre, end-to-end vector, contour length, radius of gyration and angle of each chain, indexed by time and number."""
        return self._rows_of("chain")

    @property
    def cells(self) -> pd.DataFrame:
        """``cells.csv``: centre, area, perimeter, deformation, inclination and tank-treading angle of each cell (3D: volume and surface), indexed by time
        and number."""
        return self._rows_of("cell")

    @property
    def clusters(self) -> pd.DataFrame:
        """``clusters.csv``: centre and orientation of each rigid cluster, indexed by time and number."""
        return self._rows_of("cluster")

    @property
    def bodies(self) -> pd.DataFrame:
        """The bodies of the last instant, a row each; of more than 10,000 all are in it too.
        Columns as in :attr:`Frame.bodies`, and ``stresslet_x_x``, .. in a flow."""
        table = self.folder / "summary-bodies.csv"
        if self.finished and table.exists():
            with reading(table):
                whole = numbers(table.read_text(encoding="utf-8")).rename_axis("body")
            return whole.rename(columns={f"center_{axis}": axis for axis in "xyz"})
        if not self.finished:
            return self.frames[-1].bodies
        return table_of(self.summary["bodies"])

    @property
    def frames(self) -> Frames:
        """The frames, empty where there are none."""
        found, times = self._frames.get() or (np.zeros(0, dtype=np.int64), np.zeros(0))
        return Frames(self, found, times)

    @property
    def viscosity(self) -> Viscosity:
        """The viscosity with its parts and the mean; that of a run under way from its series.

        Raises:
            Missing: The flow has none.
        """
        if self.finished:
            in_summary = self.summary.get("viscosity")
            found = Viscosity.of_summary(in_summary, self._series.get() is not None) if in_summary else None
        else:
            found = Viscosity.of_series(self.series)
        return self._needed(found, "viscosity: it takes free bodies in a simple shear")

    @property
    def quantities(self) -> pd.DataFrame:
        """What was measured, a row for each physical column of the series: unit, meaning, the last value, and the mean over its steady part with the
        half width of its 95 % interval, not a number where there is none."""
        found: dict[str, Any] = self.summary.get("quantities", {})
        rows = {name: {"unit": entry["unit"], "meaning": entry["meaning"], "last": entry["last"], **_mean_of(entry["mean"])} for name, entry in found.items()}
        kinds = {"unit": str, "meaning": str, "last": float, "mean": float, "half_width": float}
        return pd.DataFrame.from_dict(rows, orient="index", columns=list(kinds)).astype(kinds).rename_axis("quantity")

    @property
    def rheology(self) -> pd.DataFrame:
        """What a rheometer measures, of a sheared suspension: viscosity with its parts, both normal stress differences, particle pressure, contacts of a
        body. ``value`` is the mean over the steady part with the half width of its 95 % interval, or the last value, whose half width is not a number.

        Raises:
            Missing: The flow is no simple shear of free bodies.
        """
        known = self.quantities
        first = ("viscosity", "first_normal_difference", "second_normal_difference", "particle_pressure", "contact_number")
        rows = known[[name.startswith(first) for name in known.index]]
        if "viscosity" not in rows.index:
            raise Missing("viscosity: it takes free bodies in a simple shear")
        return pd.DataFrame({"value": rows["mean"].fillna(rows["last"]), "half_width": rows["half_width"], "unit": rows["unit"], "meaning": rows["meaning"]})

    @property
    def oscillation(self) -> dict[str, Any]:
        """What a shear that oscillates measures: moduli with intervals, complex viscosity, phase in degrees, harmonics (``oscillation`` of the summary).

        Raises:
            Missing: The scene has none, or the run no whole cycle.
        """
        return self._needed(self.summary.get("oscillation"), "oscillation: it takes flow.drive.shear_rate = { amplitude = .., frequency = .. } and a whole cycle")

    @property
    def shear(self) -> Shear | None:
        """The simple shear that the scene imposes; ``None`` where it imposes none."""
        return shear_of(self.scene)

    @property
    def pairs(self) -> PairDistribution:
        """The pair distribution that the program has measured, where ``output.pairs = true``."""
        return self._needed(
            self._pairs.get(), "pairs.json: the scene has no output.pairs = true; run.pair_distribution() counts the pairs of the frames"
        )

    @property
    def displacements(self) -> pd.DataFrame:
        """Mean-square displacements over the lag that the program has measured, where ``output.displacements = true``, with half widths of 95 % intervals."""
        return self._needed(self._displacements.get(), "displacements.csv: the scene has no output.displacements = true")

    @property
    def structure_factor(self) -> pd.DataFrame:
        """The structure factor over the wave number that the program has measured, where ``output.structure_factor = true``, with half widths of 95 % intervals."""
        return self._needed(self._structure_factor.get(), "structure-factor.csv: the scene has no output.structure_factor = true")

    @property
    def velocity_autocorrelation(self) -> pd.DataFrame:
        """The velocity autocorrelation over the lag that the program has measured, where ``output.velocity_autocorrelation = true``, with half widths."""
        return self._needed(self._autocorrelation.get(), "velocity-autocorrelation.csv: the scene has no output.velocity_autocorrelation = true")

    def pair_distribution(self, frames: Frames | None = None, width: float = 0.025, farthest: float | None = None) -> PairDistribution:
        """The pair distribution over frames, without them those of :meth:`steady_frames`; bins of ``width`` sums of radii up to ``farthest``."""
        return counting.pair_distribution(self.steady_frames() if frames is None else frames, width, farthest, self.shear)

    def profile(self, quantity: str, axis: str = "y", bins: int | None = None, frames: Frames | None = None) -> Profile:
        """The profile of a quantity (see :data:`turbid.profiles.QUANTITIES`) across an axis over frames, or :meth:`steady_frames`."""
        return averaging.profile(self.steady_frames() if frames is None else frames, quantity, axis, bins)

    def steady_frames(self) -> Frames:
        """The frames of the steady part of the viscosity, or else of the second half of the run."""
        frames = self.frames
        if not len(frames):
            return frames
        return frames.since(self._steady_start())

    def mean(self, column: str) -> Mean | None:
        """The mean of a column of the series over its steady part, with a 95 % interval.

        ``None`` where the run is too short or not steady; a warning then says which. In a shear the steady part has a strain of twenty at least.
        """
        series = self.series
        if column not in series:
            raise Missing(f"series.csv of {self.folder} has no column {column}; it has {', '.join(series.columns)}")
        least = LEAST_STRAIN / shear.rate if (shear := self.shear) and shear.steady else 0.0
        if (reason := shortage(series.index, series[column], least)) is not None:
            warnings.warn(f"{column} of {self.folder} has no mean: the run is too short, {reason}", stacklevel=2)
        return steady_mean(series.index, series[column], least)

    def trajectories(self, frames: Frames | None = None) -> Floats:
        """Centres of all bodies as they were followed through sides of the box, shape ``(frames, bodies, dimension)``."""
        from .trajectories import followed

        return np.array([places for places, _ in followed(self.frames if frames is None else frames)])

    @property
    def fields(self) -> xarray.Dataset:
        """The fields of all frames as a ``Dataset`` over time that reads what is asked for; needs xarray."""
        from .arrays import fields_dataset

        return fields_dataset(self)

    @property
    def plot(self) -> Plots:
        """Plots, one line each: ``run.plot.viscosity()``."""
        from .plotting import Plots

        return Plots(self)

    @property
    def animation(self) -> Animation:
        """The animation in the folder.

        Raises:
            Missing: There is none.
        """
        paths = [self.folder / f"animation{suffix}" for suffix in (".png", ".gif", ".mp4", ".webm")]
        found = max((path for path in paths if path.exists()), key=lambda path: path.stat().st_mtime_ns, default=None)
        return Animation(self._needed(found, "animation; run.animate() makes one"))

    def animate(self, out: PathLike | None = None, width: int = 640, seconds: float = 6.0, executable: PathLike | None = None) -> Animation:
        """Draws the frames as an animation by ``turbid animate``, which a notebook shows."""
        from .launch import call

        width, seconds = whole("width", width), above("seconds", seconds)
        path = Path(out) if out is not None else self.folder / "animation.png"
        call(["animate", str(self.folder), "--out", str(path), "--width", str(width), "--seconds", str(seconds)], executable)
        return Animation(path)

    def strain_at(self, time: npt.ArrayLike) -> Any:
        """The strain at a time or at times, with the sign of the rate; ``None`` where the flow is no simple shear."""
        shear = self.shear
        if shear is None:
            return None
        if shear.steady:
            sign = np.sign(shear.flow[np.flatnonzero(shear.flow)[0]])
            return sign * shear.rate * np.asarray(time)[()]
        series = self.series
        return np.interp(np.asarray(time), series.index.to_numpy(float), series["strain"].to_numpy(float))[()]

    def _steady_start(self) -> float:
        """Time from which on frames are averaged, as the program has it."""
        strains = None
        if (found := self._summary.get()) is not None:
            mean = (found.get("viscosity") or {}).get("mean")
            strains = mean["strains"] if mean else None
        elif (series := self._series.get()) is not None and (viscosity := Viscosity.of_series(series)) is not None:
            strains = viscosity.strains
        if strains and (shear := self.shear):
            if shear.steady:
                return float(strains[0] / shear.rate)
            series = self.series
            return float(np.interp(abs(strains[0]), series["strain"].abs().to_numpy(float), series.index.to_numpy(float)))
        return _START_UP * float(self._times()[-1])

    def _times(self) -> Floats:
        series = self._series.get()
        if series is not None and len(series):
            return np.asarray(series.index, dtype=float)
        return self.frames.times

    def _rows_of(self, kind: str) -> pd.DataFrame:
        """The table of all objects of a kind, by time and number."""
        missing = f"{kind}s.csv: it takes a run in time with [[{kind}s]], and not output.objects = false"
        table = self._needed(self._objects[kind].get(), missing)
        # before its first row a table has no names
        return (table if kind in table else table.rename(columns={"step": kind})).set_index(kind, append=True)

    def _needed(self, found: T | None, what: str) -> T:
        if found is None:
            raise Missing(f"{self.folder} has no {what}")
        return found


def _mean_of(mean: dict[str, Any] | None) -> dict[str, float]:
    if mean is None:
        return {"mean": np.nan, "half_width": np.nan}
    low, high = mean["interval"]
    return {"mean": mean["value"], "half_width": 0.5 * (high - low)}


def open_run(folder: PathLike) -> Run:
    """The run in an output folder, finished or under way.

    Raises:
        Missing: The folder is not there or is no run.
    """
    return Run(folder)
