"""What the studies of dry disks share: runs that are made once, and straight lines through points."""

import json
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


def line(points):
    """Slope of the straight line through (x, y), by least squares, with its standard error."""
    points = list(points)
    mean = [sum(values) / len(points) for values in zip(*points)]
    wide = sum((x - mean[0]) ** 2 for x, _ in points)
    slope = sum((x - mean[0]) * (y - mean[1]) for x, y in points) / wide
    off = sum((y - mean[1] - slope * (x - mean[0])) ** 2 for x, y in points)
    return slope, (off / max(len(points) - 2, 1) / wide) ** 0.5
