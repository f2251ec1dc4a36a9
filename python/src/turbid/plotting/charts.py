"""Charts of curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import Normalize

from ..box import Floats
from ..errors import Missing
from ..pairs import PairDistribution
from ..profiles import Profile
from ..viscosity import Viscosity
from .style import COLOURS, axes_of, finish, label

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd
    from matplotlib.axes import Axes


def viscosity_chart(series: pd.DataFrame, found: Viscosity, axes: Axes | None, parts: bool) -> Axes:
    """The curve over the strain, with the mean, its interval and the start that is left out."""
    axes = axes_of(axes)
    strain = series["strain"].abs()
    axes.plot(strain, series["viscosity"], color=COLOURS[0], label="viscosity")
    if parts:
        names = [name for name in found.parts if f"viscosity_{name}" in series and series[f"viscosity_{name}"].abs().max() > 0]
        # a single part is the whole
        for name, colour in zip(names if len(names) > 1 else [], COLOURS[2:]):
            axes.plot(strain, series[f"viscosity_{name}"], color=colour, linewidth=1.0, label=f"part: {name}")
    if found.mean is not None and found.interval is not None and found.strains is not None:
        start, end = np.abs(found.strains)
        if start > 0:
            axes.axvspan(0.0, start, color="0.5", alpha=0.15, linewidth=0, label="left out of the mean")
        axes.fill_between([start, end], *found.interval, color=COLOURS[1], alpha=0.3, linewidth=0)
        axes.plot([start, end], [found.mean] * 2, color=COLOURS[1], label=f"mean {found}, 95 %")
    axes.set(xlabel=label("strain"), ylabel=label("viscosity"))
    axes.legend(frameon=False)
    return finish(axes)


def series_chart(table: pd.DataFrame, columns: Sequence[str], axes: Axes | None, against: str) -> Axes:
    """Columns of a table over time or another column."""
    axes = axes_of(axes)
    across = table.index if against == table.index.name else table[against]
    # a run of a few steps shows each of them
    marker = "." if len(table) <= 30 else ""
    for place, column in enumerate(columns):
        axes.plot(
            across,
            table[column],
            marker=marker,
            color=COLOURS[place % len(COLOURS)],
            linestyle=["-", "--", ":"][place // len(COLOURS) % 3],
            label=label(column),
        )
    axes.set(xlabel=label(against), ylabel=label(columns[0]) if len(columns) == 1 else "")
    if len(columns) > 1:
        axes.legend(frameon=False)
    return finish(axes)


def pairs_chart(found: PairDistribution, axes: Axes | None) -> Axes:
    """The pair distribution over the separation."""
    axes = axes_of(axes)
    separation, density = found.radial.index.to_numpy(), found.radial["distribution"].to_numpy()
    half = 0.5 * (separation[1] - separation[0]) if len(separation) > 1 else 0.0
    axes.stairs(density, np.append(separation - half, separation[-1:] + half), baseline=None, color=COLOURS[0], linewidth=1.4)
    axes.axhline(1.0, color="0.4", linewidth=0.8, linestyle="--")
    frames = "1 frame" if found.configurations == 1 else f"{found.configurations} frames"
    axes.set(xlabel="separation of centres / sum of the radii", ylabel="pair distribution g(r)", ylim=(0, None))
    axes.set_title(f"{frames}, {found.coordination:.3g} neighbours within 0.1 radii", fontsize="medium")
    return finish(axes)


def pair_map_chart(found: PairDistribution) -> Axes:
    """The pair distribution over separation and direction on polar axes, in opposite directions alike."""
    import matplotlib.pyplot as plt

    if found.map is None:
        raise Missing("pairs counted from frames have no map; output.pairs = true lets the program measure it")
    axes = plt.figure(figsize=(5.4, 4.6)).add_subplot(projection="polar")
    density, separations = found.map.to_numpy(), found.map.index.to_numpy()
    half = 0.5 * (separations[1] - separations[0]) if len(separations) > 1 else 0.5
    turns = np.linspace(0.0, 2 * np.pi, 2 * density.shape[1] + 1)
    excess = np.hstack([density, density]) - 1.0
    drawn = axes.pcolormesh(turns, np.append(separations - half, separations[-1:] + half), excess, cmap="RdBu_r", norm=norm_of(excess, around_zero=True))
    axes.figure.colorbar(drawn, ax=axes, label="g(r, θ) - 1", pad=0.1)
    axes.set(ylim=(0.0, None), xlabel="direction from flow to gradient; radius: separation / sum of the radii")
    axes.grid(False)
    return axes


def structure_factor_chart(table: pd.DataFrame, axes: Axes | None) -> Axes:
    """The structure factor over the wave number."""
    axes, table = axes_of(axes), table.astype(float)
    axes.errorbar(table["wave_number"], table["structure_factor"], yerr=table["half_width"].fillna(0.0), color=COLOURS[0], linewidth=1.4, elinewidth=0.8)
    axes.axhline(1.0, color="0.4", linewidth=0.8, linestyle="--")
    axes.set(xlabel="wave number k [1 / unit of length]", ylabel="structure factor S(k)", ylim=(0, None))
    return finish(axes)


def autocorrelation_chart(table: pd.DataFrame, axes: Axes | None) -> Axes:
    """The velocity autocorrelation over the lag."""
    axes, table = axes_of(axes), table.astype(float)
    for axis, colour in zip("xyz", COLOURS):
        if (name := f"autocorrelation_{axis}") in table:
            axes.plot(table["lag"], table[name] / table[name].iloc[0], color=colour, label=f"along {axis}")
    axes.axhline(0.0, color="0.4", linewidth=0.8, linestyle="--")
    axes.set(xlabel="lag [unit of time]", ylabel="velocity autocorrelation over that without lag")
    axes.legend(frameon=False)
    return finish(axes)


def directions_chart(found: PairDistribution, axes: Axes | None) -> Axes:
    """The density of neighbours over their direction."""
    axes = axes_of(axes)
    degrees = found.angular.index.to_numpy()
    half = 0.5 * (degrees[1] - degrees[0])
    axes.stairs(found.angular["density"].to_numpy(), np.append(degrees - half, degrees[-1] + half), color=COLOURS[0], fill=True, alpha=0.8)
    axes.axhline(1.0, color="0.4", linewidth=0.8, linestyle="--")
    axes.set(xlabel="direction of neighbours [degrees from flow to gradient]", ylabel="density / its mean", xticks=range(0, 181, 30))
    return finish(axes)


def profile_chart(found: Profile, axes: Axes | None, components: Sequence[str] | None) -> Axes:
    """A profile, the axis across upwards, with a band of one standard error."""
    axes = axes_of(axes, (5.0, 4.4))
    means = found.mean.reshape(len(found.mean), -1).T
    errors = found.error.reshape(len(found.error), -1).T
    shown = [place for place in range(len(means)) if components is None or "xyz"[place] in components or means.shape[0] == 1]
    for colour, place in zip(COLOURS, shown):
        mean, error = means[place], np.nan_to_num(errors[place])
        axes.plot(mean, found.positions, color=colour, label=label(found.names[place]))
        axes.fill_betweenx(found.positions, mean - error, mean + error, color=colour, alpha=0.3, linewidth=0)
    axes.set(ylabel=f"{found.axis} [units of the scene]", xlabel=label(found.names[shown[0]] if len(shown) == 1 else found.quantity))
    axes.set_ylim(found.edges[0], found.edges[-1])
    if len(shown) > 1:
        axes.legend(frameon=False)
    frames = "1 frame" if found.frames == 1 else f"{found.frames} frames, band: one standard error"
    axes.set_title(frames, fontsize="medium")
    finish(axes).margins(x=0.05)
    return axes


def norm_of(values: Floats, around_zero: bool) -> Normalize:
    """From the smallest to the largest of numbers; of numbers that are all the same, none is made to look large.

    Of numbers of both signs, those beyond 99 % of all are left to the end of the scale: a few cells in gaps have most of the pressure.
    """
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    if around_zero:
        most = (float(np.quantile(np.abs(known), 0.99)) if len(known) else 0.0) or max(abs(low), abs(high)) or 1.0
        return Normalize(-most, most)
    scale = max(abs(low), abs(high)) or 1.0
    return Normalize(low, high) if high - low > 1e-9 * scale else Normalize(low - 0.5 * scale, high + 0.5 * scale)
