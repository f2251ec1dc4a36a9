"""The viscosity of a run: the last value, its parts, and the mean with its interval."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from .statistics import LEAST_STRAIN, Mean, shortage, steady_mean

_PARTS = ("hydrodynamic", "lubrication", "interaction", "bonds", "reynolds", "contact", "friction")


@dataclass(frozen=True, repr=False)
class Viscosity:
    """The apparent viscosity of the suspension over that of the fluid.

    Attributes:
        relative: At the last instant.
        parts: What adds up to it: ``hydrodynamic`` (1 and the stresslets of the flow), ``lubrication``, ``interaction``, ``bonds``,
            ``reynolds``, ``contact``, ``friction`` (of tangential contact forces).
        from_walls: The same from the force on the walls, where there are walls.
        mean: Mean over the steady part; ``None`` where there is none.
        interval: What 95 % confidence leaves of the mean, or, at an instant with ``accuracy``, of ``relative``.
        mean_parts: Parts of the mean.
        strains: Strains where the steady part begins and ends.
        blocks: Number of blocks from whose scatter the interval comes.
        reason: Why there is no mean.
    """

    relative: float
    parts: dict[str, float]
    from_walls: float | None = None
    mean: float | None = None
    interval: tuple[float, float] | None = None
    mean_parts: dict[str, float] = field(default_factory=dict)
    strains: tuple[float, float] | None = None
    blocks: int | None = None
    reason: str | None = None

    @property
    def value(self) -> float:
        """The mean, or the last value where there is none."""
        return self.relative if self.mean is None else self.mean

    @property
    def half_width(self) -> float | None:
        """Half the width of the interval."""
        return None if self.interval is None else 0.5 * (self.interval[1] - self.interval[0])

    def __str__(self) -> str:
        if self.half_width is not None:
            return f"{self.value:.5g} ± {self.half_width:.2g}"
        return f"{self.value:.5g}" + (f" at the end; {self.reason}" if self.reason else "")

    def __repr__(self) -> str:
        parts = " + ".join(f"{name} {value:.4g}" for name, value in (self.mean_parts or self.parts).items() if value)
        return f"<viscosity {self}: {parts}>"

    @staticmethod
    def of_summary(found: dict[str, Any], in_time: bool) -> Viscosity:
        """The viscosity in a summary."""
        mean = found.get("mean") or {}
        interval = mean.get("interval") or found.get("interval")
        return Viscosity(
            relative=found["relative"],
            parts=_parts(found),
            from_walls=found.get("from_walls"),
            mean=mean.get("relative"),
            interval=tuple(interval) if interval else None,
            mean_parts=_parts(mean),
            strains=tuple(mean["strains"]) if mean else None,
            blocks=mean.get("blocks"),
            reason=_TOO_SHORT.format((found.get("too_short") or {}).get("reason", "it has not become steady")) if in_time and not mean else None,
        )

    @staticmethod
    def of_series(series: pd.DataFrame) -> Viscosity | None:
        """The viscosity in the series of a run that has not finished; nothing where it has none."""
        if "viscosity" not in series or series["viscosity"].isna().all():
            return None
        last = series.iloc[-1]
        columns = {part: f"viscosity_{part}" for part in _PARTS if f"viscosity_{part}" in series}
        # a negative rate shears as well
        curve = series["strain"].abs(), series["viscosity"]
        mean = steady_mean(*curve, LEAST_STRAIN)
        return Viscosity(
            relative=float(last["viscosity"]),
            parts={part: float(last[column]) for part, column in columns.items()},
            from_walls=float(last["viscosity_from_walls"]) if "viscosity_from_walls" in series else None,
            mean=mean.value if mean else None,
            interval=mean.interval if mean else None,
            mean_parts={part: _mean_over(series, column, mean) for part, column in columns.items()} if mean else {},
            strains=(mean.start, mean.end) if mean else None,
            blocks=mean.blocks if mean else None,
            reason=None if mean else _TOO_SHORT.format(shortage(*curve, LEAST_STRAIN)),
        )


_TOO_SHORT = "the run is too short for a mean, {}"


def _parts(found: dict[str, Any]) -> dict[str, float]:
    # -0.0 + 0.0 is 0.0
    return {part: found[part] + 0.0 for part in _PARTS if found.get(part) is not None}


def _mean_over(series: pd.DataFrame, column: str, mean: Mean) -> float:
    """Mean of a column over a stretch of strain, along straight lines."""
    strain, values = np.abs(series["strain"].to_numpy(float)), series[column].to_numpy(float)
    inside = (strain > mean.start) & (strain < mean.end)
    knots = np.concatenate([[mean.start], strain[inside], [mean.end]])
    between = np.interp(knots, strain, values)
    return float((0.5 * np.diff(knots) * (between[1:] + between[:-1])).sum() / (mean.end - mean.start))
