"""Means of what fluctuates in time, with intervals that respect its correlation; the rules are those of the program.

A curve is averaged over stretches of equal length, its beginning is left out as far as that makes the mean more certain (MSER-5: White 1997,
doi:10.1177/003754979706900601), and the interval comes from means over blocks that grow until their scatter grows no more (Flyvbjerg & Petersen 1989,
doi:10.1063/1.457480).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import arguments
from .arguments import curve
from .box import Floats

#: Fewest blocks whose scatter counts.
FEWEST_BLOCKS = 8

_MOST_SAMPLES = 4096
_FEWEST_SAMPLES = 40
_BATCH = 5
_ROUNDING = 1e-9
_MOST_CORRELATED = 0.5


@dataclass(frozen=True)
class Mean:
    """The mean of a curve over its steady part.

    Attributes:
        value: The mean.
        half_width: Half the width of its 95 % interval.
        start: Abscissa where the steady part begins.
        end: Where it ends: the end of the curve.
        blocks: Number of blocks from whose scatter the interval comes.
    """

    value: float
    half_width: float
    start: float
    end: float
    blocks: int

    @property
    def interval(self) -> tuple[float, float]:
        """Lowest and highest value that 95 % confidence leaves."""
        return self.value - self.half_width, self.value + self.half_width

    def __str__(self) -> str:
        return f"{self.value:.5g} ± {self.half_width:.2g}"


def steady_mean(abscissas: npt.ArrayLike, values: npt.ArrayLike) -> Mean | None:
    """The mean of the steady part of a curve with its 95 % interval; ``None`` while the curve is too short for one or has not become steady."""
    x, y = curve(abscissas, values)
    known = np.isfinite(y)
    x, y = x[known], y[known]
    samples = resampled(x, y, min(max(len(x) - 1, 0), _MOST_SAMPLES))
    if len(samples) < _FEWEST_SAMPLES:
        return None
    left_out = transient(samples)
    found = None if left_out is None else _interval(samples[left_out:])
    if left_out is None or found is None:
        return None
    start = x[0] + (x[-1] - x[0]) * left_out / len(samples)
    return Mean(float(samples[left_out:].mean()), found[0], float(start), float(x[-1]), found[1])


def resampled(x: Floats, y: Floats, count: int) -> Floats:
    """Means of a curve of straight lines over so many stretches of equal length; none for fewer than two points."""
    if len(x) < 2 or count < 1:
        return np.zeros(0)
    edges = np.linspace(x[0], x[-1], count + 1)
    knots = np.union1d(x, edges)
    between = np.interp(knots, x, y)
    integral = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(knots) * (between[1:] + between[:-1]))])
    means: Floats = np.diff(np.interp(edges, knots, integral)) * count / (x[-1] - x[0])
    return means


def transient(samples: Floats) -> int | None:
    """How many samples at the beginning to leave out; ``None`` where it would be half of them: the record has not become steady."""
    count = len(samples) // _BATCH
    batches = samples[: count * _BATCH].reshape(count, _BATCH).mean(1)
    best, smallest = 0, np.inf
    for place in reversed(range(count // 2 + 1)):
        rest = batches[place:]
        if len(rest) and (uncertainty := (rest.var() + (_ROUNDING * rest.mean()) ** 2) / len(rest)) <= smallest:
            best, smallest = place, uncertainty
    return best * _BATCH if best < count // 2 else None


def blocking(samples: npt.ArrayLike) -> pd.DataFrame:
    """What blocks of 1, 2, 4, .. samples at equal distances say of their mean.

    Columns by the ``length`` of a block: ``blocks`` (their number), ``half_width`` (of the 95 % interval of the mean, if the blocks are
    independent) and ``correlation`` (of neighbouring blocks). The half width grows with the length until blocks are longer than the correlation.
    """
    values = arguments.samples("samples", samples)
    rows, length = [], 1
    while len(values) // length >= FEWEST_BLOCKS:
        means = _block_means(values, length)
        off = means - means.mean()
        squares = (off**2).sum()
        correlation = (off[1:] * off[:-1]).sum() / squares if squares > 0 else 0.0
        rows.append((length, len(means), student(len(means) - 1) * np.sqrt(squares / (len(means) - 1) / len(means)), correlation))
        length *= 2
    return pd.DataFrame(rows, columns=["length", "blocks", "half_width", "correlation"]).set_index("length")


def standard_error(samples: Floats) -> Floats:
    """Standard error of the mean over the first axis, by blocking: the largest of all lengths of blocks; ``nan`` for a single sample.

    Fewer than eight samples count as independent.
    """
    if len(samples) < 2:
        return np.full(samples.shape[1:], np.nan)
    errors, length = [], 1
    while length == 1 or len(samples) // length >= FEWEST_BLOCKS:
        means = _block_means(samples, length)
        errors.append(means.std(0, ddof=1) / np.sqrt(len(means)))
        length *= 2
    widest: Floats = np.max(errors, axis=0)
    return widest


def student(freedom: float) -> float:
    """The 97.5 % quantile of Student's distribution, to three digits from six degrees of freedom on (Abramowitz & Stegun 26.7.5)."""
    z = 1.959963984540054
    terms = [
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
        (79 * z**9 + 776 * z**7 + 1482 * z**5 - 1920 * z**3 - 945 * z) / 92160,
    ]
    return z + float(sum(term / freedom**power for power, term in enumerate(terms, start=1)))


def _interval(samples: Floats) -> tuple[float, int] | None:
    """Half width of the 95 % interval of the mean and the blocks that it comes from; nothing if even the longest blocks are correlated."""
    table = blocking(samples)
    if table.empty:
        return None
    widest = table["half_width"].to_numpy().argmax()
    half_width, last = float(table["half_width"].iloc[widest]), table.iloc[-1]
    if last["correlation"] > _MOST_CORRELATED and last["half_width"] > 0.5 * half_width and last["half_width"] > _ROUNDING * abs(samples.mean()):
        return None
    return half_width, int(table["blocks"].iloc[widest])


def _block_means(samples: Floats, length: int) -> Floats:
    """Means of the last whole blocks."""
    blocks = len(samples) // length
    means: Floats = samples[len(samples) - blocks * length :].reshape(blocks, length, *samples.shape[1:]).mean(1)
    return means
