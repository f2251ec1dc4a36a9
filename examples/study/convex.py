"""Sheared disks by the exact law of friction and by the convex one, with four lengths of the step, from the same places.

    python3 examples/study/convex.py PROGRAM

By the convex law (Anitescu and Tasora 2010) a contact that slips opens by its slip times the coefficient, in each step: its bodies stay that far apart, and count as
touching. The error is of first order in the step.
"""

import csv
import pathlib
import sys

from common import bodies, run, write_bodies

OUT = pathlib.Path("out/study/convex")
STEPS = [0.02, 0.01, 0.005, 0.0025]
#: Strain of the preparation, and of the runs that are compared, whose first quarter does not count.
BEFORE, AFTER = 1.0, 0.2

SCENE = """
title = "sheared disks by two laws of friction"
seed = 2
[domain]
size = [22.0, 22.0]
y = "walls"
[flow]
drive = {{ shear_rate = 1.0 }}
[resolution]
cells_per_radius = 4
[lubrication]
model = "pairwise"
roughness = 0.02
[[bodies]]
radius = 1.0
{placed}
[contact]
model = "inelastic"
friction = {{ coefficient = 1.0, law = "{law}" }}
roughness = 0.02
[time]
end = {end}
step = {step}
scheme = "euler"
[output]
fields = false
picture = false
"""


def measure(folder):
    """Means over time of viscosity, contacts a body, and the part of contacts that slip."""
    with open(folder / "series.csv") as table:
        rows = [row for row in csv.DictReader(table) if float(row["time"]) > 0.25 * AFTER]
    mean = lambda name: sum(float(row[name]) for row in rows) / len(rows)
    return mean("viscosity"), mean("contact_number"), mean("slipping") / (mean("sticking") + mean("slipping"))


def main():
    program = sys.argv[1]
    random = "sizes = { ratio = 1.4, share = 0.5 }\nfraction = 0.62\ngap = 0.021"
    start = bodies(run(program, OUT / "start", SCENE.format(placed=random, law="exact", end=BEFORE, step=0.01)))
    print("| step (strain) | exact: viscosity | contacts a body | part that slips | convex: viscosity | contacts a body | part that slips |\n|-|-|-|-|-|-|-|")
    for step in STEPS:
        cells = []
        for law in ["exact", "convex"]:
            folder = OUT / f"{law},step={step}"
            folder.mkdir(parents=True, exist_ok=True)
            write_bodies(folder / "places.csv", start)
            viscosity, contacts, slipping = measure(run(program, folder, SCENE.format(placed='file = "places.csv"', law=law, end=AFTER, step=step)))
            cells.append(f"{viscosity:.2f} | {contacts:.2f} | {slipping:.2f}")
        print(f"| {step} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
