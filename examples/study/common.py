"""What the studies of dry disks and spheres share: runs that are made once, straight lines through points, heaps and their slopes, intervals."""

import csv
import json
import math
import subprocess
import sys


def run(program, folder, scene):
    """Runs a scene in a folder unless it has been run there, and gives the folder of the run; what it prints goes to `log`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(scene)
    made = folder / "run"
    if not (made / "summary.json").exists():
        with open(folder / "log", "w") as log:
            code = subprocess.run([program, "run", str(folder / "scene.toml"), "--out", str(made), "--force"], stdout=log, stderr=log).returncode
        if code != 0:
            sys.exit(f"{folder}: turbid run ended with {code}; see {folder}/log")
    return made


def bodies(made):
    """Centre and radius of the bodies of a run at its end."""
    return [(body["center"], body["radius"]) for body in json.loads((made / "summary.json").read_text())["bodies"]]


def write_bodies(path, places):
    """A table of centres and radii, for `file` of a group."""
    axes = "xyz"[: len(places[0][0])]
    with open(path, "w") as table:
        table.write(",".join([*axes, "radius"]) + "\n")
        table.writelines(",".join(repr(value) for value in (*center, radius)) + "\n" for center, radius in places)


def second_half(made):
    """Slices of the profiles of each frame in the second half of a run."""
    frames = {}
    with open(made / "profile-frames.csv") as table:
        for row in csv.DictReader(table):
            frames.setdefault(float(row["time"]), []).append(row)
    times = sorted(frames)
    return [frames[time] for time in times[len(times) // 2 :]]


def mean_of(slices, name):
    """The mean of a column over slices."""
    return sum(float(row[name]) for row in slices) / len(slices)


def rate_of(slices):
    """The shear rate of the disks in slices."""
    return line((float(row["position"]), float(row["particle_velocity_x"])) for row in slices if row["particle_velocity_x"])[0]


def within_layer(slices, low, high):
    """The slices between two parts of the height of a layer, which ends where slices are no longer dense."""
    top = max(float(row["position"]) for row in slices if float(row["fraction"]) > 0.4)
    return [row for row in slices if low * top < float(row["position"]) < high * top]


def line(points):
    """Slope of the straight line through (x, y), by least squares, with its standard error."""
    points = list(points)
    mean = [sum(values) / len(points) for values in zip(*points)]
    wide = sum((x - mean[0]) ** 2 for x, _ in points)
    slope = sum((x - mean[0]) * (y - mean[1]) for x, y in points) / wide
    off = sum((y - mean[1] - slope * (x - mean[0])) ** 2 for x, y in points)
    return slope, (off / max(len(points) - 2, 1) / wide) ** 0.5


def heap(disks):
    """The disks that hang together with most others: those whose surfaces are nearer than a tenth of a radius."""
    cells = {}
    for number, ((x, y), _) in enumerate(disks):
        cells.setdefault((int(x // 3.0), int(y // 3.0)), []).append(number)
    group = list(range(len(disks)))

    def root(one):
        while group[one] != one:
            group[one] = group[group[one]]
            one = group[one]
        return one

    for number, ((x, y), radius) in enumerate(disks):
        column, row = int(x // 3.0), int(y // 3.0)
        for other in (other for i in (-1, 0, 1) for j in (-1, 0, 1) for other in cells.get((column + i, row + j), [])):
            (u, v), wide = disks[other]
            if other > number and math.hypot(x - u, y - v) < radius + wide + 0.1:
                group[root(number)] = root(other)
    sizes = {}
    for number in range(len(disks)):
        sizes[root(number)] = sizes.get(root(number), 0) + 1
    main = max(sizes, key=sizes.get)
    return [disk for number, disk in enumerate(disks) if root(number) == main]


def slopes(disks, middle, reach):
    """Tangents of the left and the right flank, by least squares over their middle three fifths: of the tops of slices three radii wide."""
    sides = [{}, {}]
    for (x, y), radius in disks:
        tops, place = sides[int(x >= middle)], int(abs(x - middle) // 3.0)
        tops[place] = max(tops.get(place, 0.0), y + radius)
    middles = [[((place + 0.5) * 3.0, top) for place, top in tops.items() if 0.2 * reach < (place + 0.5) * 3.0 < 0.8 * reach] for tops in sides]
    return [-line(points)[0] for points in middles]


#: Disks of several sizes, so that they do not order, and the mean square of their radii.
SIZES, MEAN_AREA = "sizes = { deviation = 0.12, smallest = 0.8, largest = 1.2 }", 1.0145


#: Of the 95 % interval of a mean, by degrees of freedom.
STUDENT = {1: 12.706, 2: 4.303, 3: 3.182, 4: 2.776, 5: 2.571, 7: 2.365, 9: 2.262, 11: 2.201}


def interval(values):
    """The mean of independent values, with half its 95 % interval."""
    mean = sum(values) / len(values)
    scatter = sum((value - mean) ** 2 for value in values) / (len(values) - 1)
    return mean, STUDENT[len(values) - 1] * math.sqrt(scatter / len(values))


BLOCKS = 6


def in_time(samples):
    """The mean of samples in time, with half its 95 % interval from the scatter of blocks."""
    blocks = [samples[len(samples) * place // BLOCKS : len(samples) * (place + 1) // BLOCKS] for place in range(BLOCKS)]
    return sum(samples) / len(samples), interval([sum(block) / len(block) for block in blocks])[1]


def ratio_in_time(tops, bottoms):
    """The ratio of the means of two samples in time, with half its 95 % interval: the scatter of what is left of its equation."""
    ratio = sum(tops) / sum(bottoms)
    left = in_time([top - ratio * bottom for top, bottom in zip(tops, bottoms)])[1]
    return ratio, left / (sum(bottoms) / len(bottoms))


#: Friction of sheared disks of friction 0.4 at rest.
STATIC = 0.26


def da_cruz(number):
    """Friction and fraction of sheared disks of friction 0.4 at an inertial number below 0.2 (da Cruz et al. 2005)."""
    return STATIC + number, 0.81 - 0.31 * number
