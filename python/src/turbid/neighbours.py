"""Near pairs of bodies, at a cost that grows with their number alone."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from .box import Box, Floats, Integers

# pairs that are looked at together
_CHUNK = 2_000_000


def near_pairs(centres: Floats, box: Box, reach: float) -> Iterator[tuple[Integers, Integers, Floats]]:
    """Pairs of different bodies whose centres are at most ``reach`` apart, each periodic image for itself and each pair once.

    Yields blocks of them: numbers of the first and of the second body, and the separation from the first to the image of the second.
    """
    count = len(centres)
    if count < 2 or reach <= 0:
        return
    numbers, places = box.images(centres, reach)
    grid = np.floor((places + reach) / reach).astype(np.int64)
    # a layer of empty cells all around
    shape = grid.max(0) + 2
    cells = np.ravel_multi_index(tuple(grid.T), tuple(shape))
    order = np.argsort(cells, kind="stable")
    ordered = cells[order]
    strides = np.append(np.cumprod(shape[:0:-1])[::-1], 1)
    # cells that are next to each other along the last axis follow each other
    shifts = [int(np.dot(step, strides[:-1])) for step in product((-1, 0, 1), repeat=box.dimension - 1)]
    for shift in shifts:
        begin = np.searchsorted(ordered, cells[:count] + shift - 1, "left")
        counts = np.searchsorted(ordered, cells[:count] + shift + 1, "right") - begin
        for first, place in _blocks(begin, counts):
            image = order[place]
            keep = numbers[image] > first
            first, image = first[keep], image[keep]
            separation = places[image] - places[first]
            near = (separation**2).sum(1) <= reach**2
            yield first[near], numbers[image[near]], separation[near]


def _blocks(begin: Integers, counts: Integers) -> Iterator[tuple[Integers, Integers]]:
    """For each body so many places from ``begin`` on: the body and the place, block by block."""
    ends = np.cumsum(counts)
    start = 0
    while start < len(counts):
        done = ends[start - 1] if start else 0
        stop = max(int(np.searchsorted(ends, done + _CHUNK, "right")), start + 1)
        number = counts[start:stop]
        first = np.repeat(np.arange(start, stop), number)
        within = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
        yield first, begin[first] + within
        start = stop
