"""Dry disks sheared between rough walls at a given pressure: friction of the flow and fraction against the inertial number.

    python3 examples/study/pressure.py PROGRAM [NUMBER ..]

The upper wall, with the disks that are fixed to it, moves along its normal under the pressure; the height of the layer comes out. The inertial number,
`I = rate sqrt(mass / pressure)`, is asked for by the velocity of the wall and measured in the middle half of the layer, where disks have little of the walls.
A second table has walls of other masses, which say how fast the wall gives way and should say nothing of the means.

Published, for disks of friction 0.4: `0.26 + 1.0 I` and `0.81 - 0.31 I` for I below 0.2 (da Cruz et al. 2005). Means are over the second half of each run;
the friction is that of the force on the wall, of all steps. Lengths in radii, masses such that density and pressure are 1.
"""

import csv
import math
import pathlib
import sys

from common import MEAN_AREA, SIZES, da_cruz, in_time, mean_of, rate_of, ratio_in_time, run, second_half, within_layer

OUT = pathlib.Path("out/study/pressure")
FIXED, SPACING, COUNT, START, FRACTION = 15, 2.02, 220, 0.6, 0.78
WIDTH = FIXED * SPACING
#: The time in which the pressure moves a disk by its radius, about.
UNIT = math.sqrt(math.pi * MEAN_AREA)

SCENE = """
title = "dry disks sheared at a given pressure"
seed = 1
[domain]
size = [{width}, {height}]
y = {{ lower = [0.0, 0.0], upper = [{speed}, 0.0] }}
normal_stress = 1.0
wall_mass = {wall_mass}
[flow]
model = "none"
[[bodies]]
radius = 1.0
centers = {lower}
motion = "fixed"
[[bodies]]
radius = 1.0
centers = {upper}
motion = "wall"
[[bodies]]
radius = 1.0
{sizes}
count = {count}
gap = 0.005
[contact]
model = "inelastic"
friction = {friction}
tolerance = 1e-3
[time]
end = {end}
step = {step}
[output]
every = {every}
profiles = "y"
picture = false
"""


def scene(number, strain, friction=0.4, wall_mass=1.6, step=0.004):
    """A loose layer that the wall presses and shears, to a strain, at about this inertial number."""
    between = lambda fraction: (COUNT * math.pi * MEAN_AREA + FIXED * math.pi) / fraction / WIDTH
    height, rate = round(between(START) + 2.0, 3), number / UNIT
    row = lambda y: "[" + ", ".join(f"[{0.505 + SPACING * place:.3f}, {y!r}]" for place in range(FIXED)) + "]"
    end = strain / rate
    return SCENE.format(sizes=SIZES, width=WIDTH, height=height, lower=row(1.0), upper=row(height - 1.0), speed=rate * between(FRACTION), count=COUNT,
                        friction=friction, wall_mass=wall_mass, end=end, step=min(step / rate, 0.25 * UNIT), every=end / 400)


def wall(folder):
    """Friction of the force on the wall, with half its interval, and the mean normal stress, over the second half of a run."""
    with open(folder / "series.csv") as table:
        rows = list(csv.DictReader(table))
    rows = rows[len(rows) // 2 :]
    shears, normals = ([float(row["loaded_wall_stress_" + axis]) for row in rows] for axis in "xy")
    return *ratio_in_time([-shear for shear in shears], normals), sum(normals) / len(rows)


def measure(folder):
    """Means over the second half of a run of what is in the middle half of the layer."""
    numbers, fractions = [], []
    for slices in second_half(folder):
        middle = within_layer(slices, 0.25, 0.75)
        numbers.append(rate_of(middle) * UNIT)
        fractions.append(mean_of(middle, "fraction"))
    return in_time(numbers), in_time(fractions), wall(folder)


#: Inertial numbers asked for, and the strain of each run.
RUNS = {"0.1": 16.0, "0.03": 12.0, "0.01": 8.0, "0.001": 3.0}


#: Masses per area of walls, and the inertial number asked for with them.
MASSES, NUMBER = ["0.4", "1.6", "6.4"], "0.1"


def row(first, measured):
    """A row of a table, of which the first cell is given."""
    (number, wide), (fraction, scatter), (friction, uncertain, normal) = measured
    of_friction, of_fraction = da_cruz(number)
    print(f"| {first} | {number:.4f} +- {wide:.4f} | {friction:.3f} +- {uncertain:.3f} | {of_friction:.3f} | {fraction:.4f} +- {scatter:.4f} "
          f"| {of_fraction:.4f} | {normal:.4f} |", flush=True)


def head(first):
    print(f"| {first} | inertial number in the middle | friction of the flow | da Cruz et al. | fraction in the middle | da Cruz et al. | normal stress on the wall |\n"
          "|-|-|-|-|-|-|-|")


def main():
    program, *asked = sys.argv[1:]
    head("inertial number asked for")
    for name in asked or RUNS:
        row(name, measure(run(program, OUT / name, scene(float(name), RUNS[name]))))
    if asked:
        return
    print()
    head("mass per area of the wall")
    for mass in MASSES:
        row(mass, measure(run(program, OUT / f"mass-{mass}", scene(float(NUMBER), RUNS[NUMBER], wall_mass=float(mass)))))


if __name__ == "__main__":
    main()
