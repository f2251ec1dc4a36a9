"""Bodies followed from frame to frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from .box import Floats
from .frame import Frame


def followed(frames: Iterable[Frame]) -> Iterator[tuple[Floats, Frame]]:
    """Centres of each frame as they were followed from the first of them, and the frame.

    Of all images of a centre, the one nearest to where the velocity of the frame before takes the body is the one that it moved to; so frames may be
    as far apart as bodies keep their velocity to within half a box.
    """
    places: Floats | None = None
    expected, time = np.zeros(0), 0.0
    for frame in frames:
        box, centres, velocities = frame.box, frame.centres, frame.velocities
        if places is None:
            places = centres
        else:
            ahead = places + expected * (frame.time - time)
            places = ahead + box.nearest(centres - ahead)
        # boxes above move faster by the rate at which they slide
        rows = np.round((places[:, 1] - centres[:, 1]) / box.size[1])
        expected = velocities.copy()
        expected[:, 0] += rows * box.offset_rate
        time = frame.time
        yield places.copy(), frame
