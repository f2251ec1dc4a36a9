"""Piles from a point source: disks and spheres run out of a hopper of fixed ones onto a floor; angle of repose against friction.

    python3 examples/study/pile.py PROGRAM [DISKS SPHERES]

Slopes are those of least squares through the tops over the middle three fifths of a flank, from the floor's edge of the pile to the peak; their 95 % intervals are from
the scatter over flanks and seeds. Lengths in radii, times in units of sqrt(radius / gravity).
"""

import math
import pathlib
import random
import sys

from common import bodies, heap, interval, line, run, slopes, write_bodies

OUT = pathlib.Path("out/study/pile")

SCENE = """
title = "a pile from a hopper"
seed = 1
gravity = {gravity}
[domain]
size = {size}
{walls}
[flow]
model = "none"
[[bodies]]
radius = 1.0
file = "hopper.csv"
motion = "fixed"
[[bodies]]
radius = 1.0
file = "grains.csv"
[contact]
model = "inelastic"
friction = {friction}
tolerance = 1e-3
[time]
end = {end}
step = 0.1
[output]
every = {every}
picture = false
"""

#: Half width of the opening and of the hopper.
OPENING, HALF = 10.0, 26.0
SPHERE_OPENING, SPHERE_HALF = 7.0, 16.0


def radii(count, draw):
    return [min(max(draw.gauss(1.0, 0.12), 0.8), 1.2) for _ in range(count)]


def disks(count, seed):
    """The box, the hopper with a rough floor below it, and disks on a loose lattice in it."""
    draw = random.Random(seed)
    peak = math.sqrt(count * math.pi / 0.8 * 0.6)
    width = 2.0 * 1.7 * count * math.pi / 0.8 / peak
    mouth, middle = 1.2 * peak + 10.0, 0.5 * width
    floor = [((1.0 + 2.02 * place, 1.0), 1.0) for place in range(int((width - 2.0) / 2.02))]
    slanted = [((middle + side * (OPENING + 1.0 + 1.43 * place), mouth + 1.43 * place), 1.0)
               for side in (-1, 1) for place in range(int((HALF - OPENING) / 1.43))]
    shoulder = mouth + HALF - OPENING
    spacing, across = 2.5, int((2.0 * HALF - 2.5) / 2.5)
    rows = math.ceil(count / across)
    height = shoulder + rows * spacing * 0.9 + 6.0
    upright = [((middle + side * (HALF + 1.0), shoulder + 2.02 * place), 1.0) for side in (-1, 1) for place in range(int((height - shoulder - 1.0) / 2.02))]
    grains = []
    for number, radius in enumerate(radii(count, draw)):
        row, column = divmod(number, across)
        x = middle + (column + 0.5 + 0.25 * (row % 2) - 0.125 - 0.5 * across) * spacing
        grains.append(((x + draw.uniform(-0.04, 0.04), shoulder + 2.0 + row * spacing * 0.97), radius))
    top = max(y for (_, y), _ in grains) + 4.0
    return (width, max(top, height)), floor + slanted + upright, grains


def spheres(count, seed):
    """The same of spheres, in a cone; the floor is the wall of the box, which is rough by rolling friction."""
    draw = random.Random(seed)
    peak = (count * 4.19 / 0.58 * 3.0 / math.pi * 0.2) ** (1.0 / 3.0)
    width = 2.0 * 2.6 * (count * 4.19 / 0.58 / peak) ** 0.5 + 8.0
    mouth, middle = 1.2 * peak + 8.0, 0.5 * width
    rings = [(SPHERE_OPENING + 1.0 + 1.43 * place, mouth + 1.43 * place) for place in range(int((SPHERE_HALF - SPHERE_OPENING) / 1.43))]
    shoulder = mouth + SPHERE_HALF - SPHERE_OPENING
    spacing = 2.5
    places = [(x, y) for x in grid(SPHERE_HALF - 1.5, spacing) for y in grid(SPHERE_HALF - 1.5, spacing) if math.hypot(x, y) < SPHERE_HALF - 1.5]
    layers = math.ceil(count / len(places))
    height = shoulder + layers * spacing + 6.0
    rings += [(SPHERE_HALF + 1.0, shoulder + 2.02 * place) for place in range(int((height - shoulder - 2.0) / 2.02))]
    hopper = [((middle + radius * math.cos(turn), y, middle + radius * math.sin(turn)), 1.0)
              for radius, y in rings for turn in (2.0 * math.pi * place / int(math.pi * radius / 1.01) for place in range(int(math.pi * radius / 1.01)))]
    grains = []
    for number, radius in enumerate(radii(count, draw)):
        layer, place = divmod(number, len(places))
        x, z = places[place]
        shift = 0.2 * (layer % 2) - 0.1
        grains.append(((middle + x + shift, shoulder + 2.0 + layer * spacing, middle + z + draw.uniform(-0.04, 0.04)), radius))
    return (width, max(y for (_, y, _), _ in grains) + 4.0, width), hopper, grains


def grid(half, spacing):
    steps = int(half / spacing)
    return [place * spacing for place in range(-steps, steps + 1)]


def pile(program, count, friction, seed, in_space):
    """Bodies of the pile at the end, without the hopper and what is left in it, the middle of the floor."""
    size, hopper, grains = (spheres if in_space else disks)(count, seed)
    folder = OUT / f"{'spheres' if in_space else 'disks'},{count},mu={friction},seed={seed}"
    folder.mkdir(parents=True, exist_ok=True)
    write_bodies(folder / "hopper.csv", hopper)
    write_bodies(folder / "grains.csv", grains)
    law = f"{{ coefficient = {friction}, rolling = 0.1 }}" if in_space else friction
    end = round(0.1 * count if not in_space else 0.03 * count) + 50.0
    walls = "\n".join(f'{axis} = "walls"' for axis in "xyz"[: len(size)])
    gravity = [0.0, -1.0, 0.0][: len(size)]
    text = SCENE.format(gravity=gravity, size=list(size), walls=walls, friction=law, end=end, every=end / 20)
    ended = bodies(run(program, folder, text))[len(hopper) :]
    mouth = min(center[1] for center, _ in hopper if center[1] > 2.0)
    return [(center, radius) for center, radius in ended if center[1] < mouth - 2.0], 0.5 * size[0]


def angles(program, count, friction, seed, in_space):
    """Degrees of the flanks, and the part of the bodies that are in the pile."""
    found, middle = pile(program, count, friction, seed, in_space)
    part = len(found) / count
    if in_space:
        return [math.degrees(math.atan(cone(found, middle)))], part
    found = heap(found)
    reach = 0.5 * (max(x for (x, _), _ in found) - min(x for (x, _), _ in found))
    return [math.degrees(math.atan(tangent)) for tangent in slopes(found, middle, reach)], part


def cone(found, middle):
    """Tangent of a cone: slope of the tops of rings two radii wide between a fifth and four fifths of where the pile is two radii high."""
    tops = {}
    for (x, y, z), radius in found:
        ring = int(math.hypot(x - middle, z - middle) // 2.0)
        tops.setdefault(ring, []).append(y + radius)
    # the mean of the highest of a ring, one for each two radii of its length
    mean = {}
    for ring, heights in tops.items():
        highest = sorted(heights)[-max(1, int(math.pi * (2 * ring + 1) / 2.0)) :]
        mean[ring] = sum(highest) / len(highest)
    reach = 2.0 * max(ring for ring, top in mean.items() if top > 3.0) + 2.0
    return -line(((ring + 0.5) * 2.0, top) for ring, top in mean.items() if 0.2 * reach < (ring + 0.5) * 2.0 < 0.8 * reach)[0]


def main():
    program, counts = sys.argv[1], [int(argument) for argument in sys.argv[2:]]
    disks_asked, spheres_asked = counts if counts else (500, 1000)
    print("| bodies | friction | angle of repose, degrees | part of them in the pile |\n|-|-|-|-|")
    for friction in [0.1, 0.2, 0.5, 1.0]:
        found = [angles(program, disks_asked, friction, seed, False) for seed in [1, 2, 3]]
        mean, half = interval([angle for flanks, _ in found for angle in flanks])
        print(f"| {disks_asked} disks | {friction} | {mean:.1f} +- {half:.1f} | {min(part for _, part in found):.3f} |", flush=True)
    [angle], part = angles(program, spheres_asked, 0.5, 1, True)
    print(f"| {spheres_asked} spheres, rolling friction 0.1 | 0.5 | {angle:.1f} | {part:.3f} |", flush=True)


if __name__ == "__main__":
    main()
