"""Dry disks sheared between rough walls: friction of the flow and fraction against the inertial number.

    python3 examples/study/granular.py PROGRAM

The height of the box is given, and the pressure comes out. Published, for disks of friction 0.4: `0.26 + 1.0 I` and `0.81 - 0.31 I` for I below 0.2, with
`I = rate sqrt(mass / pressure)` (da Cruz et al. 2005). Means are over the middle half of the layer and the second half of a strain of 16.
"""

import math
import pathlib
import sys

from common import MEAN_AREA, SIZES, da_cruz, in_time, mean_of, rate_of, ratio_in_time, run, second_half

OUT = pathlib.Path("out/study/granular")
WIDTH, COUNT, SPEED = 30.3, 360, 10.0

SCENE = """
title = "dry disks between rough walls"
seed = 1
[domain]
size = [{width}, {height}]
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 1.0
centers = {lower}
motion = {{ velocity = [-{speed}, 0.0] }}
[[bodies]]
radius = 1.0
centers = {upper}
motion = {{ velocity = [{speed}, 0.0] }}
[[bodies]]
radius = 1.0
{sizes}
count = {count}
gap = 0.005
[contact]
model = "inelastic"
friction = 0.4
[time]
end = {end}
step = {step}
[output]
every = {every}
profiles = "y"
picture = false
"""


def scene(fraction, strain):
    """A layer of so many disks that fill a fraction between the middles of the walls' disks, sheared by so much."""
    area = COUNT * math.pi * MEAN_AREA + 0.5 * 2 * 15 * math.pi
    between = area / fraction / WIDTH
    height = between + 2.0
    row = lambda y: "[" + ", ".join(f"[{0.505 + 2.02 * place:.3f}, {y:.6f}]" for place in range(15)) + "]"
    rate = 2.0 * SPEED / between
    end = strain / rate
    return SCENE.format(sizes=SIZES, width=WIDTH, height=height, lower=row(1.0), upper=row(height - 1.0), speed=SPEED, count=COUNT, end=end, step=0.004 / rate, every=end / 400)


def measure(folder):
    """Means over the second half of the run of what is in the middle half of the layer."""
    shears, normals, rates, fractions = [], [], [], []
    for slices in second_half(folder):
        middle = slices[len(slices) // 4 : len(slices) - len(slices) // 4]
        shears.append(abs(mean_of(middle, "particle_stress_xy")))
        normals.append(-mean_of(middle, "particle_stress_yy"))
        fractions.append(mean_of(middle, "fraction"))
        rates.append(rate_of(middle))
    pressure, rate = sum(normals) / len(normals), sum(rates) / len(rates)
    (friction, friction_width), (fraction, width) = ratio_in_time(shears, normals), in_time(fractions)
    return {"I": rate * math.sqrt(math.pi * MEAN_AREA / pressure), "mu": friction, "mu width": friction_width, "fraction": fraction, "width": width}


def main():
    program = sys.argv[1]
    print("| fraction asked for | inertial number | friction of the flow | da Cruz et al. | fraction in the middle | da Cruz et al. |\n|-|-|-|-|-|-|")
    for asked in [0.65, 0.66, 0.68]:
        found = measure(run(program, OUT / f"{asked}", scene(asked, 16.0)))
        number = found["I"]
        friction, fraction = da_cruz(number)
        print(f"| {asked} | {number:.4f} | {found['mu']:.3f} +- {found['mu width']:.3f} | {friction:.3f} | {found['fraction']:.4f} +- {found['width']:.4f} "
              f"| {fraction:.4f} |", flush=True)


if __name__ == "__main__":
    main()
