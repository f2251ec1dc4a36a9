"""Plots of a run, one line each; all return their ``Axes`` and draw into those that are given as ``axes``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy.typing as npt

from ..errors import Missing
from ..frame import Frame
from ..frames import Frames
from .bodies import COLOUR_CHOICES, Picture
from .charts import autocorrelation_chart, directions_chart, pair_map_chart, pairs_chart, profile_chart, series_chart, structure_factor_chart, viscosity_chart
from .style import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..results import Run

__all__ = ["COLOURS", "COLOUR_CHOICES", "Plots"]


class Plots:
    """Plots of a run."""

    def __init__(self, run: Run) -> None:
        self._run = run

    def viscosity(self, parts: bool = False, axes: Axes | None = None) -> Axes:
        """The viscosity over the strain, with its mean, its 95 % interval and the start that is left out; ``parts`` adds what sums up to it."""
        return viscosity_chart(self._run.series, self._run.viscosity, axes, parts)

    def series(self, columns: str | Sequence[str], against: str = "time", axes: Axes | None = None) -> Axes:
        """Columns of ``series.csv`` over the time, or ``against`` another column such as ``"strain"``; of ``forces.csv`` too."""
        names = [columns] if isinstance(columns, str) else list(columns)
        table = self._run.series
        if any(name not in table for name in names) and (self._run.folder / "forces.csv").exists():
            table = table.join(self._run.forces.drop(columns="step"))
        for name in [*names, against]:
            if name not in table and name != table.index.name:
                raise Missing(f"series.csv of {self._run.folder} has no column {name}; it has {', '.join(table.columns)}")
        return series_chart(table, names, axes, against)

    def frame(
        self,
        frame: int | Frame = -1,
        colour: str | npt.ArrayLike | None = "speed",
        contacts: bool = False,
        bonds: bool = True,
        flow: bool = True,
        streamlines: bool = False,
        view: str = "xy",
        cut: float | None = None,
        axes: Axes | None = None,
    ) -> Axes:
        """The bodies of a frame, and the flow where it holds one.

        Args:
            frame: A frame or its place among those of the run.
            colour: One of ``turbid.plotting.COLOUR_CHOICES``, or a number for each body.
            contacts: Show the forces of contacts as lines, as wide as they are large.
            bonds: Show the bonds of chains, cells and clusters.
            flow: Colour the fluid by the same quantity.
            streamlines: Show streamlines.
            view: In 3D, the plane that is looked at: ``"xy"``, ``"xz"``, ``"yz"``.
            cut: In 3D, where along the third axis the plane lies that cuts bodies and flow; without it all bodies are seen from its far end.
            axes: Where to draw.
        """
        chosen = frame if isinstance(frame, Frame) else self._run.frames[frame]
        return Picture(chosen, axes, view, cut).draw(colour, contacts, bonds, flow, streamlines)

    def pair_distribution(self, frames: Frames | None = None, axes: Axes | None = None) -> Axes:
        """The pair distribution that the program has measured, or that of frames."""
        measured = frames is None and (self._run.folder / "pairs.json").exists()
        return pairs_chart(self._run.pairs if measured else self._run.pair_distribution(frames), axes)

    def directions(self, frames: Frames | None = None, axes: Axes | None = None) -> Axes:
        """In which directions the neighbours of bodies lie."""
        measured = frames is None and (self._run.folder / "pairs.json").exists()
        return directions_chart(self._run.pairs if measured else self._run.pair_distribution(frames), axes)

    def pair_map(self) -> Axes:
        """The pair distribution in the plane of the shear that the program has measured, over separation and direction: polar axes."""
        return pair_map_chart(self._run.pairs)

    def structure_factor(self, axes: Axes | None = None) -> Axes:
        """The structure factor over the wave number, with its 95 % interval."""
        return structure_factor_chart(self._run.structure_factor, axes)

    def velocity_autocorrelation(self, axes: Axes | None = None) -> Axes:
        """The velocity autocorrelation along each axis over its value without lag, over the lag."""
        return autocorrelation_chart(self._run.velocity_autocorrelation, axes)

    def profile(
        self,
        quantity: str = "velocity",
        axis: str = "y",
        bins: int | None = None,
        frames: Frames | None = None,
        components: Sequence[str] | None = None,
        axes: Axes | None = None,
    ) -> Axes:
        """The profile of a quantity across an axis; of a vector all ``components``, or those that are named: ``"x"``."""
        return profile_chart(self._run.profile(quantity, axis, bins, frames), axes, components)
