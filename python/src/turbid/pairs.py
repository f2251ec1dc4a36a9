"""How bodies lie to each other: pair distribution, directions of neighbours, coordination number; as the program defines them.

Pairs are counted by their separation over the sum of the radii, each periodic image for itself, over those of an ideal gas of points in the same box:
uniform where centres can be, which is up to a mean radius from walls.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import combinations
from math import comb, pi
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from .arguments import above
from .box import Box, Floats
from .errors import Invalid
from .neighbours import near_pairs
from .shear import Shear

if TYPE_CHECKING:
    from .frame import Frame

#: Gap in mean radii of the pair up to which two bodies are neighbours.
NEAR = 0.1

_WIDTH = 0.025
_FARTHEST = 4.0
_DIRECTIONS = 18
# integrals over all directions of the product of the sizes of 0, 1, .. components of the unit vector
_SOLID = {2: [2 * pi, 4.0, 2.0], 3: [4 * pi, 2 * pi, 8 / 3, 1.0]}


@dataclass(frozen=True)
class PairDistribution:
    """Means over configurations.

    Attributes:
        radial: ``distribution``, the density of pairs over that of an ideal gas in the same box, by ``separation`` over the sum of the radii
            (middles of bins).
        angular: ``density`` of neighbours over its mean, by direction in ``degrees`` from that of the flow towards that of the
            gradient (from x to y without a shear; middles of bins over half a turn).
        coordination: Mean number of neighbours of a body: others with a gap below 0.1 mean radii.
        configurations: Number of frames that were averaged.
        partial: The same as ``radial`` of each two sizes, by their radii, the smaller one first; only what the program has measured has it.
        map: Density over that of an ideal gas in the plane of the shear, a row for each separation and a column for each direction in degrees over half a
            turn; ``None`` where the frames were counted here.
    """

    radial: pd.DataFrame
    angular: pd.DataFrame
    coordination: float
    configurations: int
    partial: dict[tuple[float, float], pd.DataFrame] = field(default_factory=dict)
    map: pd.DataFrame | None = None

    @staticmethod
    def of_program(found: dict[str, Any]) -> PairDistribution:
        """What the program has written into ``pairs.json``."""
        radial = np.array(found["radial"], dtype=float).reshape(-1, 2)
        angular = np.array(found["angular"], dtype=float).reshape(-1, 2)
        of_two = [(tuple(two["radii"]), np.array(two["radial"], dtype=float).reshape(-1, 2)) for two in found.get("partial", [])]
        partial = {(radii[0], radii[1]): _radial(*rows.T) for radii, rows in of_two}
        in_plane = _map(found["map"]) if "map" in found else None
        return PairDistribution(_radial(*radial.T), _angular(*angular.T), found["coordination"], found["configurations"], partial, in_plane)


def _map(found: dict[str, Any]) -> pd.DataFrame:
    separations, degrees = pd.Index(found["separations"], name="separation"), pd.Index(found["degrees"], name="degrees")
    values = np.array(found["distribution"], dtype=float).reshape(len(separations), len(degrees))
    return pd.DataFrame(values, index=separations, columns=degrees)


def pair_distribution(frames: Iterable[Frame], width: float = _WIDTH, farthest: float | None = None, shear: Shear | None = None) -> PairDistribution:
    """The pair distribution of frames of the same bodies, one at a time.

    Args:
        frames: The frames.
        width: Width of a bin in sums of radii.
        farthest: Farthest separation in sums of radii; without it 4, or what half a period or the room between walls allows.
        shear: The shear that directions refer to; without it they go from x to y.
    """
    width, farthest = above("width", width), None if farthest is None else above("farthest", farthest, 1.0)
    counts: _Counts | None = None
    for frame in frames:
        counts = counts or _Counts(frame.box, frame.radii, width, farthest, shear)
        counts.add(frame.box, frame.centres)
    if counts is None:
        raise Invalid("there are no frames to count pairs in")
    return counts.distribution()


class _Counts:
    def __init__(self, box: Box, radii: Floats, width: float, farthest: float | None, shear: Shear | None) -> None:
        if len(radii) < 2:
            raise Invalid(f"there are no pairs of {len(radii)} bodies")
        self.box, self.radii, self.width = box, radii, width
        axes = np.eye(box.dimension)
        self.flow: Floats = shear.flow if shear else axes[0]
        self.gradient: Floats = axes[shear.gradient] if shear else axes[1]
        bins = int(max((min(_most(box, radii), farthest or _FARTHEST) - 1.0) / width + 1e-9, 0.0))
        self.radial = np.zeros(bins)
        self.angular = np.zeros(_DIRECTIONS)
        self.neighbours = 0
        self.configurations = 0

    def add(self, box: Box, centres: Floats) -> None:
        bins = len(self.radial)
        reach = 2 * self.radii.max() * (1 + max(self.width * bins, 0.5 * NEAR))
        for first, second, separation in near_pairs(centres, box, reach):
            sums = self.radii[first] + self.radii[second]
            gaps = np.linalg.norm(separation, axis=1) - sums
            places = (np.maximum(gaps, 0.0) / sums / self.width).astype(np.int64)
            self.radial += np.bincount(places[places < bins], minlength=bins)
            near = gaps < 0.5 * NEAR * sums
            self.neighbours += int(near.sum())
            turn = np.mod(np.arctan2(separation[near] @ self.gradient, separation[near] @ self.flow), pi) / pi
            self.angular += np.bincount(np.minimum((turn * _DIRECTIONS).astype(np.int64), _DIRECTIONS - 1), minlength=_DIRECTIONS)
        self.configurations += 1

    def distribution(self) -> PairDistribution:
        edges = 1.0 + self.width * np.arange(len(self.radial) + 1, dtype=float)
        radial = self.radial / (self.configurations * _ideal_pairs(self.box, self.radii, edges))
        mean = self.neighbours / _DIRECTIONS
        angular = self.angular / mean if mean else 0.0 * self.angular
        degrees = 180.0 * (np.arange(_DIRECTIONS) + 0.5) / _DIRECTIONS
        coordination = 2.0 * self.neighbours / (self.configurations * len(self.radii))
        return PairDistribution(_radial(0.5 * (edges[1:] + edges[:-1]), radial), _angular(degrees, angular), coordination, self.configurations)


def _radial(separation: Floats, distribution: Floats) -> pd.DataFrame:
    return pd.DataFrame({"distribution": distribution}, index=pd.Index(separation, name="separation"))


def _angular(degrees: Floats, density: Floats) -> pd.DataFrame:
    return pd.DataFrame({"density": density}, index=pd.Index(degrees, name="degrees"))


def _reachable(box: Box, radii: Floats) -> Floats:
    """The lengths that centres can reach."""
    walled = ~np.array(box.periodic)
    return box.size - 2 * radii.mean() * walled


def _most(box: Box, radii: Floats) -> float:
    """The farthest separation in sums of radii of which a pair has no second image."""
    room = np.where(box.periodic, 0.5 * box.size, _reachable(box, radii))
    return float(room.min() / (2 * radii.max()))


def _ideal_pairs(box: Box, radii: Floats, edges: Floats) -> Floats:
    """Pairs of an ideal gas between edges of the separation: those ``r n`` apart have the density ``prod over walls (1 - r |n_k| / L_k) / V``."""
    dimension, lengths = box.dimension, _reachable(box, radii)
    factors = [-1.0 / length for length, periodic in zip(lengths, box.periodic) if not periodic]
    pairs = np.zeros(len(edges) - 1)
    for axes in range(len(factors) + 1):
        product = sum(float(np.prod(chosen)) for chosen in combinations(factors, axes))
        power = dimension + axes
        shell = np.diff(edges**power) / power
        pairs += _SOLID[dimension][axes] * product / lengths.prod() * _sum_of_powers(radii, power) * shell
    return pairs


def _sum_of_powers(radii: Floats, power: int) -> float:
    """Sum over all pairs of a power of their sums of radii."""
    moments = [float((radii**k).sum()) for k in range(power + 1)]
    ordered = sum(comb(power, k) * moments[k] * moments[power - k] for k in range(power + 1))
    return 0.5 * (ordered - 2.0**power * moments[power])
