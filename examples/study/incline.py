"""Layers of dry disks that flow down a rough incline: friction and fraction against the inertial number, at a pressure that their weight gives.

    python3 examples/study/incline.py PROGRAM

In steady flow the friction is the tangent of the incline, whatever the disks do, and the inertial number is the same at all depths (GDR MiDi 2004). Published, for
sheared disks of friction 0.4: `0.26 + 1.0 I` and `0.81 - 0.31 I` for I below 0.2, with `I = rate sqrt(mass / pressure)` (da Cruz et al. 2005). Lengths in radii,
times in units of sqrt(radius / gravity).
"""

import csv
import math
import pathlib
import sys

from common import bodies, in_time, line, run

OUT = pathlib.Path("out/study/incline")
FIXED, SPACING, COUNT, HEIGHT = 16, 2.02, 320, 72.0
WIDTH = FIXED * SPACING

#: Mean square of the radii.
MEAN_AREA = 1.0145

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
{placed}
[contact]
model = "inelastic"
friction = {friction}
[time]
end = {end}
step = {step}
[output]
every = {every}
profiles = "y"
picture = false
"""

RANDOM = f"sizes = {{ deviation = 0.12, smallest = 0.8, largest = 1.2 }}\ncount = {COUNT}\ngap = 0.02"


def scene(gravity, placed, friction, end, step, samples):
    floor = "[" + ", ".join(f"[{0.5 + SPACING * place:.3f}, 1.0]" for place in range(FIXED)) + "]"
    return SCENE.format(gravity=gravity, width=WIDTH, height=HEIGHT, floor=floor, placed=placed, friction=friction, end=end, step=step, every=end / samples)


def flow(program, degrees, end=400.0):
    """The folder of a layer that is settled and then set free on an incline."""
    settled = bodies(run(program, OUT / "settled", scene([0.0, -1.0], RANDOM, 0.4, 40.0, 0.08, 1)))[FIXED:]
    folder = OUT / f"{degrees}"
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "layer.csv", "w") as table:
        table.write("x,y,radius\n")
        table.writelines(f"{x!r},{y!r},{radius!r}\n" for (x, y), radius in settled)
    angle = math.radians(degrees)
    return run(program, folder, scene([math.sin(angle), -math.cos(angle)], 'file = "layer.csv"', 0.4, end, 0.08, 400))


def measure(folder):
    """Means over the second half of the run, of the slices between a fifth and seven tenths of the layer's height."""
    frames = {}
    with open(folder / "profile-frames.csv") as table:
        for row in csv.DictReader(table):
            frames.setdefault(float(row["time"]), []).append(row)
    times = sorted(frames)
    numbers, frictions, fractions = [], [], []
    for time in times[len(times) // 2 :]:
        slices = frames[time]
        top = max(float(row["position"]) for row in slices if float(row["fraction"]) > 0.4)
        middle = [row for row in slices if 0.2 * top < float(row["position"]) < 0.7 * top]
        mean = lambda name: sum(float(row[name]) for row in middle) / len(middle)
        pressure = -mean("particle_stress_yy")
        rate = line((float(row["position"]), float(row["particle_velocity_x"])) for row in middle)[0]
        numbers.append(rate * math.sqrt(math.pi * MEAN_AREA / pressure))
        frictions.append(abs(mean("particle_stress_xy")) / pressure)
        fractions.append(mean("fraction"))
    return {"I": in_time(numbers), "friction": in_time(frictions), "fraction": in_time(fractions)}


def main():
    program = sys.argv[1]
    print("| incline, degrees | its tangent | friction of the flow | inertial number | da Cruz et al. | fraction | da Cruz et al. |\n|-|-|-|-|-|-|-|")
    for degrees in [15.0, 16.0, 17.5, 19.0, 21.0]:
        found = measure(flow(program, degrees))
        tangent = math.tan(math.radians(degrees))
        (number, wide), (friction, uncertain), (fraction, scatter) = found["I"], found["friction"], found["fraction"]
        print(f"| {degrees} | {tangent:.4f} | {friction:.4f} +- {uncertain:.4f} | {number:.4f} +- {wide:.4f} | {max(tangent - 0.26, 0.0):.4f} "
              f"| {fraction:.4f} +- {scatter:.4f} | {0.81 - 0.31 * number:.4f} |", flush=True)


if __name__ == "__main__":
    main()
