"""Means of what fluctuates in time, with intervals that respect its correlation; the rules are those of the program.

A curve is averaged over stretches of equal length; a tenth of it is left out, or more where a start-up stands out (MSER-5: White 1997,
doi:10.1177/003754979706900601), and the interval comes from the scatter of 3 and of 6 blocks of the rest by Student's distribution: the wider of
the two. The tests of both read the same curves and must find the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from . import arguments
from .arguments import curve
from .box import Floats

#: Numbers of blocks whose scatter gives an interval.
BLOCKS = (3, 6)

#: Fewest samples, or blocks, whose scatter counts.
FEWEST = 8

#: Least strain of the steady part of a mean viscosity.
LEAST_STRAIN = 20.0

_MOST_SAMPLES = 4096
_FEWEST_SAMPLES = 40
_BATCH = 5
_ALWAYS = 0.1
_NOTABLY = 0.6
_SEVERAL = 16
_STEEP = 5.0
_MOST_CORRELATED = 0.7
_ROUNDING = 1e-9
_FEW = (12.706205, 4.302653, 3.182446, 2.776445, 2.570582)


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


def steady_mean(abscissas: npt.ArrayLike, values: npt.ArrayLike, least: float = 0.0) -> Mean | None:
    """The mean of the steady part of a curve with its 95 % interval.

    ``None`` where there is none, or it is shorter than ``least``: :func:`shortage` says why.
    """
    found = _steady(abscissas, values, least)
    return found if isinstance(found, Mean) else None


def shortage(abscissas: npt.ArrayLike, values: npt.ArrayLike, least: float = 0.0) -> str | None:
    """Why a curve has no steady mean, in the words of the program; ``None`` where it has one."""
    found = _steady(abscissas, values, least)
    return found if isinstance(found, str) else None


def _steady(abscissas: npt.ArrayLike, values: npt.ArrayLike, least: float) -> Mean | str:
    x, y = curve(abscissas, values)
    known = np.isfinite(y)
    x, y = x[known], y[known]
    samples = resampled(x, y, min(max(len(x) - 1, 0), _MOST_SAMPLES))
    if len(samples) < _FEWEST_SAMPLES:
        return "it has too few steps"
    left_out = transient(samples)
    if left_out is None:
        return "it still drifts"
    start = x[0] + (x[-1] - x[0]) * left_out / len(samples)
    if x[-1] - start < least:
        return "its steady part is too short to estimate its fluctuations"
    rest = samples[left_out:]
    slope, correlation = _trend(_block_means(rest, _SEVERAL))
    if slope > _STEEP:
        return "it still drifts"
    if correlation > _MOST_CORRELATED:
        return "its fluctuations last too long"
    half_width, blocks = _interval(rest)
    return Mean(float(rest.mean()), half_width, float(start), float(x[-1]), blocks)


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
    """How many samples at the beginning to leave out: a tenth, or as many as MSER-5 says if that makes the mean notably more certain.

    ``None`` where it would be half of them: the record has not become steady.
    """
    count = len(samples) // _BATCH
    batches = samples[: count * _BATCH].reshape(count, _BATCH).mean(1)
    half = count // 2
    least = min(int(np.ceil(_ALWAYS * count)), half)
    rests = [batches[place:] for place in range(least, half + 1)]
    variances = [(rest.var() + (_ROUNDING * rest.mean()) ** 2) / len(rest) for rest in rests]
    best = int(np.argmin(variances))
    if variances[best] >= _NOTABLY * variances[0]:
        return least * _BATCH
    return (least + best) * _BATCH if least + best < half else None


def blocking(samples: npt.ArrayLike) -> pd.DataFrame:
    """What blocks of 1, 2, 4, .. samples at equal distances say of their mean.

    Columns by the ``length`` of a block: ``blocks`` (their number, eight at least), ``half_width`` (of the 95 % interval of the mean, if the blocks are
    independent) and ``correlation`` (of neighbouring blocks). The half width grows with the length until blocks are longer than the correlation.
    """
    values = arguments.samples("samples", samples)
    rows, length = [], 1
    while (count := len(values) // length) >= FEWEST:
        means = _block_means(values[len(values) - count * length :], count)
        rows.append((length, count, _half_width(means), _trend(means)[1]))
        length *= 2
    return pd.DataFrame(rows, columns=["length", "blocks", "half_width", "correlation"]).set_index("length")


def standard_error(samples: Floats) -> Floats:
    """Standard error of the mean over the first axis: the largest that 3 and 6 blocks and single samples say; ``nan`` for a single sample.

    Fewer than eight samples count as independent.
    """
    count = len(samples)
    if count < 2:
        return np.full(samples.shape[1:], np.nan)
    numbers = (*BLOCKS, count) if count >= FEWEST else (count,)
    errors = [means.std(0, ddof=1) / np.sqrt(len(means)) for number in numbers for means in [_block_means(samples, number)]]
    widest: Floats = np.max(errors, axis=0)
    return widest


def student(freedom: float) -> float:
    """The 97.5 % quantile of Student's distribution, to three digits from six degrees of freedom on (Abramowitz & Stegun 26.7.5)."""
    if freedom in range(1, len(_FEW) + 1):
        return _FEW[int(freedom) - 1]
    z = 1.959963984540054
    terms = [
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
        (79 * z**9 + 776 * z**7 + 1482 * z**5 - 1920 * z**3 - 945 * z) / 92160,
    ]
    return z + float(sum(term / freedom**power for power, term in enumerate(terms, start=1)))


def _interval(samples: Floats) -> tuple[float, int]:
    """Half width of the 95 % interval of the mean, the wider that few long blocks say, and their number."""
    return max((_half_width(_block_means(samples, blocks)), blocks) for blocks in BLOCKS)


def _half_width(means: Floats) -> float:
    """Half width of the 95 % interval of the mean of independent samples."""
    return student(len(means) - 1) * float(means.std(ddof=1)) / np.sqrt(len(means))


def _trend(numbers: Floats) -> tuple[float, float]:
    """The slope of numbers over its standard error, and the correlation of neighbours; both are 0 for numbers that are all the same."""
    off = numbers - numbers.mean()
    squares = float(off @ off)
    if squares <= (_ROUNDING * numbers.mean()) ** 2 * len(numbers):
        return 0.0, 0.0
    places = np.arange(len(numbers)) - 0.5 * (len(numbers) - 1)
    spread = float(places @ places)
    slope = float(places @ off) / spread
    beside = float(((off - slope * places) ** 2).sum())
    error = np.sqrt(beside / (len(numbers) - 2) / spread)
    with np.errstate(divide="ignore"):
        return float(np.abs(slope) / error), float(off[1:] @ off[:-1]) / squares


def _block_means(samples: Floats, blocks: int) -> Floats:
    """Means of so many blocks, equally long but for a sample."""
    edges = len(samples) * np.arange(blocks + 1) // blocks
    means: Floats = np.array([samples[start:end].mean(0) for start, end in zip(edges[:-1], edges[1:], strict=True)])
    return means
