"""CPU seconds (user and system, one rank) and peak memory of scenes, with one program or two beside each other.

    ./run bench              of this version
    ./run bench REVISION     of this version and of an earlier one, built beside it; both run in turn, the least of three runs counts
"""

import os
import sys
import tempfile

SCENES = [
    ("`examples/random.toml`, the whole run", "examples/random.toml", []),
    ("`examples/shear.toml` to strain 1", "examples/shear.toml", []),
    ("1,000 spheres at 0.3 with films, one solve", "examples/cost/spheres1000.toml", ["lubrication.model=pairwise"]),
    ("`examples/crowd3d.toml`, a strain of 0.1", "examples/crowd3d.toml", []),
    ("64 spheres with inertia, sheared box, a strain of 0.3", "examples/bench/inertia64.toml", []),
    ("40 disks with inertia, closed box, to t = 10", "examples/bench/inertia40.toml", []),
    ("32 spheres of 8 sizes with films, one solve", "examples/bench/sizes32.toml", []),
    ("10,000 dry disks to t = 2.5", "examples/cost/pile10000.toml", ["output.picture=false"]),
]

RUNS = 3


def measure(program, scene, overrides):
    """CPU seconds and megabytes of a run; nothing if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        sets = [part for override in overrides for part in ("--set", override)]
        command = [program, "run", scene, "--out", os.path.join(folder, "run"), *sets]
        process = os.posix_spawn(program, command, os.environ, file_actions=[
            (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0), (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0)])
        _, status, usage = os.wait4(process, 0)
    return (usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024) if status == 0 else None


def main():
    programs = sys.argv[1:]
    names = ["this version", "before"][: len(programs)]
    print("| scene | " + " | ".join(f"{name}: CPU s | MB" for name in names) + (" | times faster |" if len(programs) == 2 else " |"))
    print("|-" * (1 + 2 * len(programs) + (len(programs) == 2)) + "|")
    for words, scene, overrides in SCENES:
        # in turn, so that a machine that is busy for a while slows both
        rounds = [[measure(program, scene, overrides) for program in programs] for _ in range(RUNS)]
        found = [min((row[place] for row in rounds if row[place]), default=None) for place in range(len(programs))]
        cells = [f"{entry[0]:.2f} | {entry[1]:.0f}" if entry else "fails | " for entry in found]
        ratio = [f"{found[1][0] / found[0][0]:.1f}"] if len(found) == 2 and all(found) else [""] * (len(found) == 2)
        print("| " + " | ".join([words, *cells, *ratio]) + " |", flush=True)


if __name__ == "__main__":
    main()
