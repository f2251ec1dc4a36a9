"""Dry disks sheared between rough walls: friction of the flow and fraction against the inertial number.

    python3 examples/study/granular.py PROGRAM

The height of the box is given, and the pressure comes out. Published, for disks of friction 0.4: `0.26 + 1.0 I` and `0.81 - 0.31 I` for I below 0.2, with
`I = rate sqrt(mass / pressure)` (da Cruz et al. 2005). Means and 95 % intervals are those of `profiles.csv` over the middle half of the layer.
"""

import csv
import math
import pathlib
import subprocess
import sys

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
sizes = {{ deviation = 0.12, smallest = 0.8, largest = 1.2 }}
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
    area = COUNT * math.pi * 1.0145 + 0.5 * 2 * 15 * math.pi
    between = area / fraction / WIDTH
    height = between + 2.0
    row = lambda y: "[" + ", ".join(f"[{0.505 + 2.02 * place:.3f}, {y:.6f}]" for place in range(15)) + "]"
    rate = 2.0 * SPEED / between
    end = strain / rate
    return SCENE.format(width=WIDTH, height=height, lower=row(1.0), upper=row(height - 1.0), speed=SPEED, count=COUNT, end=end, step=0.004 / rate, every=end / 200)


def weighted(rows, name):
    """Mean over the middle half of the slices, with its half width."""
    chosen = [row for row in rows[len(rows) // 4 : len(rows) - len(rows) // 4] if row[name] != ""]
    values = [float(row[name]) for row in chosen]
    widths = [float(row[f"{name}_half_width"]) for row in chosen if row[f"{name}_half_width"] != ""]
    return sum(values) / len(values), (sum(widths) / len(widths) if widths else math.nan)


def measure(folder):
    with open(folder / "profiles.csv") as table:
        rows = list(csv.DictReader(table))
    shear, shear_width = weighted(rows, "particle_stress_xy")
    normal, _ = weighted(rows, "particle_stress_yy")
    fraction, fraction_width = weighted(rows, "fraction")
    middle = rows[len(rows) // 4 : len(rows) - len(rows) // 4]
    points = [(float(row["position"]), float(row["particle_velocity_x"])) for row in middle]
    mean = [sum(values) / len(points) for values in zip(*points)]
    rate = sum((y - mean[0]) * (u - mean[1]) for y, u in points) / sum((y - mean[0]) ** 2 for y, _ in points)
    mass = math.pi * 1.0145
    return {"I": rate * math.sqrt(mass / -normal), "mu": shear / -normal, "mu width": shear_width / -normal, "fraction": fraction, "width": fraction_width}


def main():
    program = sys.argv[1]
    print("| fraction asked for | inertial number | friction of the flow | da Cruz et al. | fraction in the middle | da Cruz et al. |\n|-|-|-|-|-|-|")
    for asked in [0.68, 0.72, 0.74, 0.755]:
        folder = OUT / f"{asked}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "scene.toml").write_text(scene(asked, 8.0))
        if not (folder / "run" / "summary.json").exists():
            with open(folder / "log", "w") as log:
                code = subprocess.run([program, "run", str(folder / "scene.toml"), "--out", str(folder / "run"), "--force"], stdout=log, stderr=log).returncode
            if code != 0:
                sys.exit(f"{folder}: turbid run ended with {code}; see {folder}/log")
        found = measure(folder / "run")
        number = found["I"]
        print(f"| {asked} | {number:.4f} | {found['mu']:.3f} +- {found['mu width']:.3f} | {0.26 + number:.3f} | {found['fraction']:.4f} +- {found['width']:.4f} "
              f"| {0.81 - 0.31 * number:.4f} |", flush=True)


if __name__ == "__main__":
    main()
