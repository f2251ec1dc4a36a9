"""Makes the curves and windows of this folder: viscosities of sheared suspensions over long strains (an hour on one core).

    python tests/data/viscosity/make.py target/release/turbid target/viscosity

needs ``pip install ./python``. ``DIMENSION-FRACTION-SEED.txt`` has the means of the relative viscosity over stretches of 0.1 of strain; ``windows.csv`` parts of them (rows
of the curve), the mean of the whole run from strain 5 on and that of all seeds, and mean, half width, start and blocks of the window, empty where it has none.
A run that is in the folder already is not made again, and one that stops counts as far as it came; ``--windows`` as the only argument makes the windows alone.
"""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd

from turbid.statistics import LEAST_STRAIN, resampled, steady_mean

HERE = Path(__file__).parent
STEP = 0.1
START_UP = 5.0
SCENE = """
[domain]
size = {size}
[flow]
drive = {{ shear_rate = 1.0, periodic = "sheared" }}
[resolution]
cells_per_radius = 3
[method]
inverse = "auto"
[[bodies]]
radius = 1.0
fraction = 0.4
gap = 0.02
[lubrication]
model = "pairwise"
roughness = 1e-2
[contact]
model = "inelastic"
[time]
end = {end}
[output]
every = 100.0
fields = false
picture = false
"""
SIZES = {2: [15.0, 15.0], 3: [6.5, 6.5, 6.5]}
ENDS = {2: 100, 3: 60}
SEEDS = {(2, 0.2): 1, (2, 0.3): 2, (2, 0.4): 3, (2, 0.5): 2, (3, 0.2): 1, (3, 0.3): 1, (3, 0.4): 1}
# strains of the windows, in turn, and between their beginnings
LENGTHS = (24, 30, 36)
BETWEEN = 7


def make_runs(turbid: str, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for (dimension, fraction), seeds in SEEDS.items():
        scene = folder / f"{dimension}d.toml"
        scene.write_text(SCENE.format(size=SIZES[dimension], end=ENDS[dimension]))
        for seed in range(1, seeds + 1):
            out = folder / f"{dimension}d-{fraction}-{seed}"
            settings = ["--set", f"bodies.0.fraction={fraction}", "--set", f"seed={seed}", "--out", str(out)]
            if not out.exists():
                subprocess.run([turbid, "run", str(scene), *settings], check=False)
            series = pd.read_csv(out / "series.csv")
            strain, viscosity = series["strain"].to_numpy(), series["viscosity"].to_numpy()
            whole = int(strain[-1] / STEP)
            kept = np.append(strain[strain < whole * STEP], whole * STEP)
            means = resampled(kept, np.interp(kept, strain, viscosity), whole)
            (HERE / f"{out.name}.txt").write_text("".join(f"{mean:.5g}\n" for mean in means))


def make_windows() -> None:
    curves = {path.stem: np.loadtxt(path) for path in sorted(HERE.glob("*.txt"))}
    kind = {name: name.rsplit("-", 1)[0] for name in curves}
    rest = {name: values[round(START_UP / STEP) :] for name, values in curves.items()}
    seeds = {one: np.concatenate([rest[name] for name in curves if kind[name] == one]).mean() for one in kind.values()}
    with (HERE / "windows.csv").open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["curve", "from", "to", "long_mean", "mean_of_seeds", "mean", "half_width", "start", "blocks"])
        for name, values in curves.items():
            for number, start in enumerate(range(0, len(values), round(BETWEEN / STEP))):
                end = start + round(LENGTHS[number % len(LENGTHS)] / STEP)
                if end <= len(values):
                    mean = steady_mean(STEP * np.arange(start, end), values[start:end], LEAST_STRAIN)
                    found = [mean.value, mean.half_width, mean.start, mean.blocks] if mean else [""] * 4
                    table.writerow([name, start, end, f"{rest[name].mean():.6g}", f"{seeds[kind[name]]:.6g}", *found])


if __name__ == "__main__":
    if sys.argv[1] != "--windows":
        make_runs(sys.argv[1], Path(sys.argv[2]))
    make_windows()
