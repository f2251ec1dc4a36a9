"""Columns of dry disks that collapse on a rough floor: run-out and final height against the aspect ratio, and the slope of the deposit.

    python3 examples/study/collapse.py PROGRAM [DISKS]

A column of half width R is settled between smooth walls, set free in a wide box, and comes to rest. Published: run-out `2.5 a` below an aspect ratio `a` of 2 and
`3.25 a^0.7` above (Staron & Hinch 2005, friction 1), height `0.65 a^0.4` (Lube et al. 2005). Lengths in units of R.
"""

import math
import pathlib
import sys

from common import bodies, heap, line, run, slopes, write_bodies

OUT = pathlib.Path("out/study/collapse")
PACKED = 0.82

SCENE = """
seed = {seed}
gravity = [0.0, -1.0]
[domain]
size = [{width}, {height}]
x = "walls"
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 1.0
{placed}
[contact]
model = "inelastic"
friction = {friction}
[time]
end = {end}
step = 0.05
[output]
every = {every}
picture = false
"""

#: How disks are placed before they settle.
RANDOM = "sizes = {{ deviation = 0.15, smallest = 0.75, largest = 1.3 }}\ncount = {count}\ngap = 0.02"


def published(aspect):
    """Run-out by Staron and Hinch."""
    return 2.5 * aspect if aspect < 2.0 else 3.25 * aspect ** 0.7


def collapse(program, count, aspect, friction, seed):
    half = math.sqrt(count * math.pi * 1.023 / (2.0 * PACKED * aspect))
    end = round(1.5 * math.sqrt(2.0 * half * aspect) + 10.0, 1)
    size = {"width": 2.0 * half, "height": 1.35 * half * aspect + 6.0}
    settle = SCENE.format(seed=seed, **size, placed=RANDOM.format(count=count), friction=0, end=end, every=end)
    disks = bodies(run(program, OUT / f"{count},a={aspect},seed={seed}", settle))
    highest = max(y + radius for (_, y), radius in disks)
    wide = 2.0 * half * (2.0 * published(aspect) + 2.0)
    folder = OUT / f"{count},a={aspect},mu={friction},seed={seed}"
    folder.mkdir(parents=True, exist_ok=True)
    write_bodies(folder / "column.csv", [((x - half + 0.5 * wide, y), radius) for (x, y), radius in disks])
    end = round(4.0 * math.sqrt(2.0 * highest) + 10.0, 1)
    size = {"width": wide, "height": highest + 3.0}
    release = SCENE.format(seed=seed, **size, placed='file = "column.csv"', friction=friction, end=end, every=end / 20.0)
    disks = heap(bodies(run(program, folder, release)))
    middle = 0.5 * wide
    reach = 0.5 * (max(x for (x, _), _ in disks) - min(x for (x, _), _ in disks))
    height = max(y + radius for (x, y), radius in disks if abs(x - middle) < 0.2 * half + 3.0)
    return {"disks": count, "aspect": highest / half, "friction": friction, "runout": reach / half - 1.0, "height": height / half,
            "angle": math.degrees(math.atan(sum(slopes(disks, middle, reach)) / 2))}


def exponent(rows, quantity):
    """Power of the aspect ratio with which a quantity goes, with its standard error."""
    return "{:.2f} +- {:.2f}".format(*line((math.log(row["aspect"]), math.log(row[quantity])) for row in rows))


def main():
    program, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 500
    if count < 200:
        sys.exit(f"{count} disks: of fewer than 200 a tall column leaves its middle bare; take more")
    rows = []
    print("| disks | aspect ratio | friction | run-out | published, friction 1 | final height | slope of the deposit, degrees |\n|-|-|-|-|-|-|-|")
    for aspect, friction in [(0.6, 0.5), (1.0, 0.5), (1.5, 0.5), (3.0, 0.5), (5.0, 0.5), (8.0, 0.5), (1.0, 0.2), (1.0, 1.0)]:
        row = collapse(program, count, aspect, friction, 1)
        rows.append(row)
        print("| {disks} | {aspect:.2f} | {friction} | {runout:.2f} | {law:.2f} | {height:.3f} | {angle:.1f} |".format(**row, law=published(row["aspect"])), flush=True)
    own = [row for row in rows if row["friction"] == 0.5]
    for name, side in [("below 2", [row for row in own if row["aspect"] < 2.0]), ("above 2", [row for row in own if row["aspect"] > 2.0])]:
        print(f"run-out goes with the power {exponent(side, 'runout')} of aspect ratios {name}")
    print(f"final height goes with the power {exponent([row for row in own if row['aspect'] > 1.0], 'height')} of aspect ratios above 1")


if __name__ == "__main__":
    main()
