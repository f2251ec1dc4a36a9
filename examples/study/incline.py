"""Layers of dry disks that flow down a rough incline: friction and fraction against the inertial number, at a pressure that their weight gives.

    python3 examples/study/incline.py PROGRAM

In steady flow the friction is the tangent of the incline, whatever the disks do, and the inertial number is the same at all depths (GDR MiDi 2004). Published, for
sheared disks of friction 0.4: `0.26 + 1.0 I` and `0.81 - 0.31 I` for I below 0.2, with `I = rate sqrt(mass / pressure)` (da Cruz et al. 2005). Lengths in radii,
times in units of sqrt(radius / gravity).
"""

import math
import pathlib
import sys

from common import MEAN_AREA, SIZES, STATIC, da_cruz, in_time, mean_of, rate_of, run, second_half, within_layer

OUT = pathlib.Path("out/study/incline")
FIXED, SPACING, COUNT, HEIGHT, START = 16, 2.02, 320, 72.0, 0.55
WIDTH = FIXED * SPACING

SCENE = """
title = "dry disks on an incline"
seed = 1
gravity = {gravity}
[domain]
size = [{width}, {height}]
y = "walls"
[flow]
model = "none"
[[bodies]]
radius = 1.0
centers = {floor}
motion = "fixed"
[[bodies]]
radius = 1.0
{sizes}
count = {count}
region = [[0.0, 0.0], [{width}, {top}]]
[contact]
model = "inelastic"
friction = 0.4
tolerance = 1e-3
[time]
end = {end}
step = 0.08
[output]
every = {every}
profiles = "y"
picture = false
"""


def scene(degrees, end):
    """A loose layer that falls on the incline."""
    angle, top = math.radians(degrees), 2.0 + COUNT * math.pi * MEAN_AREA / START / WIDTH
    floor = "[" + ", ".join(f"[{0.5 + SPACING * place:.3f}, 1.0]" for place in range(FIXED)) + "]"
    return SCENE.format(gravity=[math.sin(angle), -math.cos(angle)], width=WIDTH, height=HEIGHT, floor=floor, sizes=SIZES, count=COUNT, top=top,
                        end=end, every=end / 400)


def measure(folder):
    """Means over the second half of the run, of the slices between a fifth and seven tenths of the layer's height."""
    numbers, frictions, fractions = [], [], []
    for slices in second_half(folder):
        middle = within_layer(slices, 0.2, 0.7)
        pressure = -mean_of(middle, "particle_stress_yy")
        numbers.append(rate_of(middle) * math.sqrt(math.pi * MEAN_AREA / pressure))
        frictions.append(abs(mean_of(middle, "particle_stress_xy")) / pressure)
        fractions.append(mean_of(middle, "fraction"))
    return {"I": in_time(numbers), "friction": in_time(frictions), "fraction": in_time(fractions)}


def main():
    program = sys.argv[1]
    print("| incline, degrees | its tangent | friction of the flow | inertial number | da Cruz et al. | fraction | da Cruz et al. |\n|-|-|-|-|-|-|-|")
    for degrees in [16.0, 17.5, 19.0, 21.0, 23.0]:
        found = measure(run(program, OUT / f"{degrees}", scene(degrees, 400.0)))
        tangent = math.tan(math.radians(degrees))
        (number, wide), (friction, uncertain), (fraction, scatter) = found["I"], found["friction"], found["fraction"]
        print(f"| {degrees} | {tangent:.4f} | {friction:.4f} +- {uncertain:.4f} | {number:.4f} +- {wide:.4f} | {max(tangent - STATIC, 0.0):.4f} "
              f"| {fraction:.4f} +- {scatter:.4f} | {da_cruz(number)[1]:.4f} |", flush=True)


if __name__ == "__main__":
    main()
