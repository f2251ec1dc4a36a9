"""The viscosity of dense suspensions with friction, in about three quarters of an hour on two cores; what is there is not run again.

    ./run study

Every point is a run of the program, started by `turbid sweep`; two sweeps run side by side. Tables and charts go to docs/study.md and beside it.
"""

import csv
import math
import pathlib
import random
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).parent
OUT = pathlib.Path("out/study")
DOCS = pathlib.Path("docs")

FRICTION = ["0", "0.2", "0.5", "1"]
#: The part of tangential forces is what is left: without friction it has no column.
PARTS = ["series.viscosity", "series.viscosity_hydrodynamic", "series.viscosity_lubrication", "series.viscosity_contact", "series.first_normal_difference",
         "series.particle_pressure", "series.contact_number"]
SPACE = PARTS + ["series.second_normal_difference"]

#: By the name of a scene beside this file, the longest first: keys that are varied, seeds, quantities.
SWEEPS = {
    "spheres": ({"bodies.0.fraction": ["0.1", "0.2", "0.3", "0.4", "0.45", "0.5"], "contact.friction": FRICTION}, 1, SPACE),
    "disks": ({"bodies.0.fraction": ["0.1", "0.3", "0.5", "0.6", "0.66", "0.7"], "contact.friction": FRICTION}, 1, PARTS),
    "reversal": ({"contact.friction": ["0.5"]}, 3, ["last.viscosity"]),
    "thickening": ({"contact.friction.critical_load": ["0.1", "1", "3", "10", "30", "100"]}, 1, PARTS),
}

#: Studies by scripts of their own beside this one.
ALONE = ["convex", "granular", "pressure", "incline", "pile", "collapse"]


def sweep(program, name):
    """Runs what is missing of a sweep and gives its table."""
    varied, seeds, quantities = SWEEPS[name]
    command = [program, "sweep", str(HERE / f"{name}.toml"), "--out", str(OUT / name), "--seeds", str(seeds), "--quantity", ",".join(quantities)]
    for key, values in varied.items():
        command += ["--vary", f"{key}={','.join(values)}"]
    OUT.mkdir(parents=True, exist_ok=True)
    with open(OUT / f"{name}.log", "w") as log:
        code = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode
    if code != 0:
        sys.exit(f"{name}: turbid sweep ended with {code}; see {OUT / name}.log")
    return read(name)


def read(name):
    """The table of a sweep, with the reasons why runs ended."""
    with open(OUT / name / "sweep.csv") as table:
        rows = list(csv.DictReader(table))
    remarks = (OUT / name / "sweep.md").read_text()
    for row in rows:
        point = re.escape(", ".join(f"{key} = {row[key]}" for key in SWEEPS[name][0]))
        jammed = re.findall(point + r": .*strain ([0-9.]+), bodies are jammed", remarks)
        without = re.findall(point + r": .*at time ([0-9.]{1,4})[0-9]* no rate goes", remarks)
        row["ended"] = "".join([f"jammed at strain {strain}" for strain in jammed] + [f"no rate at this stress from time {time} on" for time in without])
    return rows


def number(text):
    return float(text) if text not in ("", None) else math.nan


def with_half_width(row, quantity, digits=3):
    """A mean with half its interval, as a table has it."""
    mean, low, high = (number(row.get(name, "")) for name in (quantity, f"{quantity}.low", f"{quantity}.high"))
    if math.isnan(mean):
        return ""
    return f"{mean:.{digits}g}" + ("" if math.isnan(low) else f" +- {float(f'{0.5 * (high - low):.2g}'):g}")


def jamming(points):
    """The fraction at which `(1 - fraction / jamming)^-2` diverges, by least squares of logarithms over (fraction, viscosity) pairs."""
    def misses(limit):
        return sum((math.log(value) + 2.0 * math.log(1.0 - fraction / limit)) ** 2 for fraction, value in points)
    low, high = max(fraction for fraction, _ in points) * 1.001, 1.2
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(80):
        one, two = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, two) if misses(one) < misses(two) else (one, high)
    return 0.5 * (low + high)


def jamming_with_interval(rows):
    """The same with its 95 % interval, from points that scatter as their own intervals say."""
    points = [(number(row["fraction_placed"]), number(row["series.viscosity"]), number(row["series.viscosity.high"]) - number(row["series.viscosity"])) for row in rows]
    points = [point for point in points if not math.isnan(point[1])]
    draw = random.Random(1)
    def drawn():
        off = [(fraction, value * math.exp(draw.gauss(0.0, min(half, value) / 1.96 / value if half == half else 0.0))) for fraction, value, half in points]
        return jamming(off)
    draws = sorted(drawn() for _ in range(400))
    return jamming([point[:2] for point in points]), draws[10], draws[389]


def table(rows, columns):
    """Markdown of rows; columns are names with what makes a cell of a row."""
    lines = ["| " + " | ".join(columns) + " |", "|-" * len(columns) + "|"]
    lines += ["| " + " | ".join(cell(row) for cell in columns.values()) + " |" for row in rows]
    return "\n".join(lines)


def flow(row):
    """The part of the flow and its films."""
    return number(row["series.viscosity_hydrodynamic"]) + number(row["series.viscosity_lubrication"])


def tangential(row):
    """The part of tangential forces of contacts."""
    return number(row["series.viscosity"]) - flow(row) - number(row["series.viscosity_contact"])


def to_digits(value):
    if math.isnan(value):
        return ""
    return f"{value:.3g}" if abs(value) > 1e-9 else "0"


def viscosity_of(row):
    """Its viscosity, or why the run ended."""
    return row["ended"] or with_half_width(row, "series.viscosity")


def figures(rows, spheres):
    columns = {
        "fraction": lambda row: f"{number(row['fraction_placed'] or row['bodies.0.fraction']):.3f}",
        "friction": lambda row: row["contact.friction"],
        "viscosity": viscosity_of,
        "flow and films": lambda row: to_digits(flow(row)),
        "contacts: normal": lambda row: with_half_width(row, "series.viscosity_contact"),
        "tangential": lambda row: to_digits(tangential(row)),
        "N1": lambda row: with_half_width(row, "series.first_normal_difference", 2),
        "N2": lambda row: with_half_width(row, "series.second_normal_difference", 2),
        "particle pressure": lambda row: with_half_width(row, "series.particle_pressure"),
        "contacts a body": lambda row: to_digits(number(row["series.contact_number"])),
    }
    if not spheres:
        del columns["N2"]
    return table(rows, columns)


def limits(rows, least):
    lines = []
    for friction in FRICTION:
        own = [row for row in rows if row["contact.friction"] == friction and number(row["fraction_placed"]) > least]
        limit, low, high = jamming_with_interval(own)
        lines.append({"friction": friction, "jamming": f"{limit:.3f}", "interval": f"{low:.3f} to {high:.3f}"})
    return table(lines, {"friction": lambda row: row["friction"], "fraction at which it diverges": lambda row: row["jamming"],
                         "95 % interval": lambda row: row["interval"]})


def transient():
    """Viscosity and parts against the strain since the reversal, means over the seeds."""
    runs = []
    for path in sorted((OUT / "reversal" / "runs").glob("*/series.csv")):
        with open(path) as series:
            rows = list(csv.DictReader(series))
        turn = max(number(row["strain"]) for row in rows)
        place = next(place for place, row in enumerate(rows) if number(row["strain"]) == turn)
        runs.append([(turn - number(row["strain"]), row) for row in rows[place:]] + [("before", rows[place - 1])])
    columns = ["viscosity", "viscosity_hydrodynamic", "viscosity_lubrication", "viscosity_contact", "viscosity_friction"]

    def mean(strain, column):
        values = []
        for run in runs:
            if strain == "before":
                values.append(number(run[-1][1][column]))
                continue
            steps = [(at, number(row[column])) for at, row in run[:-1]]
            after = next((place for place, (at, _) in enumerate(steps) if at >= strain), len(steps) - 1)
            (left, low), (right, high) = steps[max(after - 1, 0)], steps[after]
            values.append(low if right == left else low + (high - low) * (strain - left) / (right - left))
        middle = sum(values) / len(values)
        spread = math.sqrt(sum((value - middle) ** 2 for value in values) / max(len(values) - 1, 1) / len(values))
        return f"{middle:.3g} +- {spread:.2g}"

    strains = ["before", 0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8]
    rows = [{"strain": str(strain), **{column: mean(strain, column) for column in columns}} for strain in strains]
    names = ["viscosity", "flow", "films", "contacts", "friction"]
    cells = {name: (lambda row, column=column: row[column]) for name, column in zip(names, columns)}
    return table(rows, {"strain since the reversal": lambda row: row["strain"], **cells})


def thickening(rows):
    return table(rows, {
        "stress over critical load": lambda row: f"{10.0 / number(row['contact.friction.critical_load']):.3g}",
        "viscosity": viscosity_of,
        "contacts: normal": lambda row: with_half_width(row, "series.viscosity_contact"),
        "tangential": lambda row: to_digits(tangential(row)),
        "contacts a body": lambda row: to_digits(number(row["series.contact_number"])),
    })


def references(rows):
    """Ours beside discrete elements with lubrication of the same scene (examples/study/discrete_elements.csv)."""
    with open(HERE / "discrete_elements.csv") as file:
        known = list(csv.DictReader(line for line in file if not line.startswith("#")))
    lines = []
    for other in known:
        same = [row for row in rows if row["contact.friction"] == other["friction"] and abs(number(row["bodies.0.fraction"]) - number(other["fraction"])) < 1e-9]
        if same and same[0]["series.viscosity"]:
            lines.append({**other, "ours": same[0]})
    return table(lines, {
        "fraction, friction": lambda row: f"{row['fraction']}, {row['friction']}",
        "viscosity": lambda row: with_half_width(row["ours"], "series.viscosity"),
        "discrete elements": lambda row: f"{row['viscosity']} +- {row['interval']}",
        "contacts": lambda row: to_digits(number(row["ours"]["series.viscosity_contact"]) + tangential(row["ours"])),
        "discrete elements: contacts": lambda row: row["contact"],
        "flow and films": lambda row: to_digits(flow(row["ours"])),
        "discrete elements: films": lambda row: row["hydrodynamic"],
        "N1": lambda row: with_half_width(row["ours"], "series.first_normal_difference", 2),
        "over viscosity: ours": lambda row: f"{number(row['ours']['series.first_normal_difference']) / number(row['ours']['series.viscosity']):+.2f}",
        "discrete elements: N1 over viscosity": lambda row: row["first"],
    })


def alone(program, name):
    """What one of the scripts beside this one prints."""
    OUT.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([sys.executable, str(HERE / f"{name}.py"), program], stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{name}.py ended with {done.returncode}")
    return done.stdout.strip()


def page(tables, alone_parts):
    parts = {
        "DISKS": figures(tables["disks"], False),
        "SPHERES": figures(tables["spheres"], True),
        "DISKS_LIMITS": limits(tables["disks"], 0.45),
        "SPHERES_LIMITS": limits(tables["spheres"], 0.25),
        "REFERENCES": references(tables["spheres"]),
        "TRANSIENT": transient(),
        "THICKENING": thickening(tables["thickening"]),
        **{name.upper(): text for name, text in alone_parts.items()},
    }
    text = (DOCS / "parts" / "study.md").read_text()
    for name, part in parts.items():
        text = text.replace(f"{{{name}}}", part)
    (DOCS / "study.md.part").write_text(text)
    (DOCS / "study.md.part").replace(DOCS / "study.md")
    for name in ("disks", "spheres"):
        chart = (OUT / name / "sweep-series.viscosity.svg").read_text()
        for column, words in [("series.viscosity", "relative viscosity"), ("bodies.0.fraction", "fraction"), ("contact.friction", "friction")]:
            chart = chart.replace(column, words)
        (DOCS / f"study-{name}.svg").write_text(chart)


def main():
    program = sys.argv[1]
    with ThreadPoolExecutor(2) as pool:
        jobs = {name: pool.submit(sweep, program, name) for name in SWEEPS}
        alone_jobs = {name: pool.submit(alone, program, name) for name in ALONE}
        tables = {name: job.result() for name, job in jobs.items()}
    page(tables, {name: job.result() for name, job in alone_jobs.items()})
    print("docs/study.md")


if __name__ == "__main__":
    main()
