"""Starting the program: results, refusals, failures, progress."""

import os
import re
import shutil
import signal
import threading
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import DRY, SCALAR, WALLS

import turbid
from turbid.errors import Refused
from turbid.process import message_in
from turbid.progress import Line
from turbid.toml import document, inline


@pytest.mark.parametrize(
    ("message", "parts"),
    [
        (
            "a b/s.toml:37: bodies[0].fraction = 1.3: must lie between 0 and 1",
            ("bodies[0].fraction", "1.3", "must lie between 0 and 1", "a b/s.toml", 37, False),
        ),
        ("--set: bodies[0].radius = -1: must be positive", ("bodies[0].radius", "-1", "must be positive", None, None, True)),
        ("--set: unknown key flux; known keys: flow", ("flux", None, "unknown key flux; known keys: flow", None, None, True)),
        ('--set "bo=\\"gus: x": must be key=value', (None, None, "must be key=value", None, None, True)),
        ("s.toml:3: missing key domain.size; for example", ("domain.size", None, "missing key domain.size; for example", "s.toml", 3, False)),
        (
            "resolution needs one of spacing, cells_per_radius; x",
            ("resolution", None, "resolution needs one of spacing, cells_per_radius; x", None, None, False),
        ),
        ('s.toml:4: title = "a: b": is odd', ("title", '"a: b"', "is odd", "s.toml", 4, False)),
        ("out/a.toml: No such file", (None, None, "No such file", "out/a.toml", None, False)),
        ("accuracy = 0.01: is more than 2.5 can do: no", ("accuracy", "0.01", "is more than 2.5 can do: no", None, None, False)),
    ],
)
def test_a_refusal_has_its_parts(message, parts):
    found = Refused(message)
    assert (found.key, found.value, found.remedy, found.file, found.line, found.override) == parts
    assert str(found) == message


def test_what_mpirun_adds_is_left_out():
    rule = "-" * 74
    noted = f"turbid: warning: slow\nturbid: a.toml:1: x = 2: no\n{rule}\nPrimary job terminated\n{rule}\n"
    assert message_in(noted) == "a.toml:1: x = 2: no"
    assert message_in("nothing of ours\n") is None


@pytest.mark.parametrize("ranks", [1, 2])
def test_refusals_of_the_program(ranks, tmp_path):
    with pytest.raises(turbid.Refused) as caught:
        turbid.run(WALLS, set={"bodies.0.fraction": 1.3}, out=tmp_path / "no", ranks=ranks)
    refused = caught.value
    assert (refused.key, refused.value, refused.override) == ("bodies[0].fraction", "1.3", True)
    assert "between 0 and 1" in refused.remedy and not (tmp_path / "no").exists()


def test_refusals_of_a_file_and_of_a_dict(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(document({**WALLS, "seed": -1}))
    with pytest.raises(turbid.Refused) as caught:
        turbid.run(path, out=tmp_path / "no", ranks=1)
    line = path.read_text().splitlines().index("seed = -1") + 1
    assert (caught.value.key, caught.value.value, caught.value.file, caught.value.line) == ("seed", "-1", "scene.toml", line)
    with pytest.raises(turbid.Refused) as caught:
        turbid.run({**WALLS, "seed": -1}, out=tmp_path / "no", ranks=1)
    assert (caught.value.key, caught.value.file, caught.value.line) == ("seed", None, None)
    assert "/" not in str(caught.value), "a dict has no file"
    with pytest.raises(turbid.Refused, match="nothing.toml"):
        turbid.plan(tmp_path / "nothing.toml")
    with pytest.raises(turbid.Refused, match="unknown key bodies.0..colour"):
        turbid.plan({**WALLS, "bodies": [{"radius": 1.0, "count": 2, "colour": 3}]})


def test_a_folder_that_is_taken_is_refused(scalar):
    with pytest.raises(turbid.Refused, match="choose another folder") as caught:
        turbid.run(SCALAR, out=scalar.folder, ranks=1)
    assert caught.value.file == str(scalar.folder)
    told = str(caught.value)
    assert "with force=True" in told and f"turbid.open({str(scalar.folder)!r}) reads it" in told and "--" not in told, told
    assert turbid.run(SCALAR, out=scalar.folder, ranks=1, force=True).finished


def test_failures_carry_code_and_text(tmp_path):
    program = tmp_path / "broken"
    program.write_text("#!/bin/sh\necho begun\necho 'turbid: rank 1: it broke' >&2\nexit 1\n")
    program.chmod(0o755)
    with pytest.raises(turbid.Failed, match="it broke") as caught:
        turbid.run(SCALAR, ranks=1, executable=program)
    assert caught.value.code == 1 and "begun" in caught.value.printed
    program.write_text("#!/bin/sh\nkill -SEGV $$\n")
    with pytest.raises(turbid.Failed, match=r"ended by signal 11 \(SIGSEGV\); .* has no checkpoint yet: start it again") as caught:
        turbid.run(SCALAR, ranks=1, executable=program)
    assert (caught.value.code, caught.value.signal) == (-11, 11)
    with pytest.raises(turbid.Failed, match="no program that can be started"):
        turbid.run(SCALAR, executable=tmp_path / "absent")
    with pytest.raises(ValueError, match="ranks = 0"):
        turbid.run(SCALAR, ranks=0)
    with pytest.raises(turbid.Failed, match="starts several ranks, is not installed"):
        turbid.run(SCALAR, launcher="no-such-launcher {ranks}")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"ranks": "2"}, r"ranks = '2': must be a whole number, as ranks=2"),
        ({"ranks": 1.5}, r"ranks = 1.5: must be a whole number"),
        ({"ranks": True}, r"ranks = True: must be a whole number"),
        ({"set": ["a=1"]}, r"set = \['a=1'\]: must be a dict of keys of the scene with their values, as set="),
        ({"set": {3: 1}}, r"set = \{3: 1\}: must be a dict"),
        ({"set": {"seed": None}}, r"None has no place in a scene"),
        ({"launcher": "mpirun -n 2"}, r"launcher = 'mpirun -n 2': must be a command with \{ranks\}"),
        ({"launcher": ""}, r"launcher = '': must be a command"),
    ],
)
def test_arguments_that_cannot_be_used_say_what_to_give(arguments, message, tmp_path):
    with pytest.raises(turbid.Invalid, match=message) as caught:
        turbid.run(SCALAR, out=tmp_path / "no", **arguments)
    assert isinstance(caught.value, turbid.TurbidError)
    with pytest.raises(turbid.Invalid, match="scene = 5: must be the path of a scene file, or a dict"):
        turbid.run(5)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_killed_run_names_the_signal_and_how_to_go_on(ranks, tmp_path):
    out = tmp_path / "killed"

    def kill():
        while not (out / "checkpoint.h5").exists():
            time.sleep(0.05)
        # those that simulate, by the folder that they write to
        for process in Path("/proc").glob("[0-9]*"):
            words = (process / "cmdline").read_bytes().split(b"\0") if (process / "cmdline").exists() else []
            if words and words[0].endswith(b"turbid") and str(out).encode() in words:
                os.kill(int(process.name), signal.SIGKILL)
                return

    threading.Thread(target=kill, daemon=True).start()
    with pytest.raises(turbid.Failed) as caught:
        turbid.run(WALLS, set={"time.end": 50.0, "output.checkpoint": 1e-9}, out=out, ranks=ranks, progress=False)
    assert caught.value.signal == 9
    message = str(caught.value)
    assert message.startswith("turbid was ended by signal 9 (SIGKILL, as the system does where memory is short); "), message
    assert message.endswith(f"turbid.resume({str(out)!r}) goes on from the last checkpoint")


def test_the_executable_is_found_by_argument_variable_and_path(tmp_path, monkeypatch):
    real = turbid.find_executable()
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        shutil.copy("/bin/true", tmp_path / name / "turbid")
    one, two = (str(tmp_path / name / "turbid") for name in ("one", "two"))
    monkeypatch.setenv("PATH", f"{tmp_path / 'two'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("TURBID", one)
    assert turbid.find_executable(real) == real
    assert turbid.find_executable() == one
    monkeypatch.delenv("TURBID")
    assert turbid.find_executable() == two


def test_overrides_and_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("two.csv").write_text("1.0,1.0\n3.0,3.0\n")
    scene = {"title": "Two disks, ü!", "domain": {"size": [4.0, 4.0]}, "flow": {"drive": {"shear_rate": 1.0}}, "resolution": {"cells_per_radius": 4},
             "bodies": [{"radius": 0.5, "file": "two.csv"}]}  # fmt: skip
    run = turbid.run(scene, set={"flow.viscosity": 2.0, "flow.drive": {"shear_rate": np.float64(3.0)}}, ranks=1)
    assert run.folder == Path("out/two-disks") and run.name == "two-disks"
    assert run.scene["flow"]["viscosity"] == 2.0 and run.scene["flow"]["drive"]["shear_rate"] == 3.0
    assert run.viscosity.mean is None and run.viscosity.reason is None and 1.0 < run.viscosity.value < 2.0
    assert run.printed and "relative viscosity" in run.printed


def test_a_scene_survives_as_toml():
    scene = {"title": 'a "b"\n\\ é \x7f', "seed": 3, "flag": True, "gravity": (0.0, -1e-9), "none": [], "domain": {"size": np.array([4, 2]), "y": {"lower": [1.0]}},
             "bodies": [{"radius": 0.5, "motion": {"path": [[0, 0], [1, 2.5]]}}, {"count": np.int64(2)}]}  # fmt: skip
    back = tomllib.loads(document(scene))
    assert back == {**scene, "gravity": [0.0, -1e-9], "domain": {"size": [4, 2], "y": {"lower": [1.0]}}}
    assert inline(float("inf")) == "inf"
    with pytest.raises(turbid.Invalid, match="has no place in a scene"):
        document({"title": None})


def test_a_run_goes_on_as_if_it_had_not_stopped(tmp_path, dry):
    first = turbid.run(DRY, set={"time.end": 0.5}, out=tmp_path / "half", ranks=1, progress=False)
    assert first.series.index[-1] == 0.5
    whole = turbid.resume(first.folder, set={"time.end": 1.0}, ranks=2, progress=False)
    assert whole.finished and whole.series.index[-1] == 1.0
    assert list(whole.frames.times[:-1]) == sorted(whole.frames.times[:-1])
    with pytest.raises(turbid.Refused) as caught:
        turbid.resume(first.folder, set={"seed": 3}, ranks=1)
    assert caught.value.override and "keeps its scene" in caught.value.remedy


def test_progress_is_told_while_it_runs(tmp_path, capsys):
    seen = []
    scene = {**WALLS, "time": {"end": 0.6, "step": 1e-3}}
    turbid.run(scene, out=tmp_path / "a", ranks=1, progress=seen.append)
    assert seen and all(0 <= told.fraction <= 1 and told.end == 0.6 for told in seen)
    assert [told.time for told in seen] == sorted(told.time for told in seen)
    assert re.match(r"time 0\.\d+ of 0.6, step \d+, viscosity \d", str(seen[-1]))
    turbid.run(scene, out=tmp_path / "b", ranks=1)
    assert re.search(r"^time 0\.\d+ of 0.6, step", capsys.readouterr().err, re.MULTILINE)


def test_a_terminal_shows_one_line_that_goes_away(capsys):
    line = Line()
    for part in (0.25, 0.5):
        line.show(turbid.Progress(part, 1.0, int(100 * part), 2.5, 1.0, 1.0 / part - 1.0))
    line.end()
    shown = capsys.readouterr().err.split("\r")
    assert shown[2].startswith("█" * 15 + "░" * 15 + " time 0.5 of 1, step 50, viscosity 2.5000, 1 s left")
    assert shown[-2].strip() == shown[-1] == "" and "\n" not in "".join(shown)


def test_an_interrupt_leaves_a_checkpoint_to_go_on_from(tmp_path):
    out = tmp_path / "long"

    def interrupt():
        while not (out / "series.csv").exists() or len((out / "series.csv").read_text().splitlines()) < 4:
            time.sleep(0.05)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    with pytest.raises(KeyboardInterrupt):
        turbid.run(WALLS, set={"time.end": 50.0, "output.every": 10.0}, out=out, ranks=1, progress=False)
    stopped = turbid.open(out)
    assert not stopped.finished and (out / "checkpoint.h5").exists()
    reached = stopped.series.index[-1]
    again = turbid.resume(out, set={"time.end": float(reached) + 0.05}, ranks=1, progress=False)
    assert again.finished and again.series.index[-1] > reached


def test_a_plan_says_what_would_be_built():
    found = turbid.plan(WALLS)
    assert "sharp" in found.built["bodies"] and "gravity" in found.not_built
    assert {"grid", "unknowns", "memory", "time"} <= set(found.costs) and "MB" in found.costs["memory"]
    assert str(found).startswith("built")


def test_an_animation_is_a_picture_that_a_notebook_shows(dry):
    with pytest.raises(turbid.Missing, match="run.animate"):
        dry.animation  # noqa: B018
    made = dry.animate(width=200, seconds=1.0)
    assert made.path.read_bytes().startswith(b"\x89PNG") and dry.animation == made
    assert made._repr_html_().startswith("<img src='data:image/png;base64,")
    with pytest.raises((turbid.Refused, turbid.Failed)):
        dry.animate(out=dry.folder / "no" / "where.png")


def test_notes_are_passed_on_and_errors_are_told_once(tmp_path, capsys, scalar):
    program = tmp_path / "noting"
    program.write_text(
        f"#!/bin/sh\necho 'turbid: a note' >&2\necho 'mpirun: chatter' >&2\nmkdir -p {tmp_path}/o\ncp {scalar.folder}/summary.json {tmp_path}/o\n"
    )
    program.chmod(0o755)
    turbid.run(SCALAR, out=tmp_path / "o", ranks=1, executable=program)
    assert capsys.readouterr().err == "turbid: a note\n"
    with pytest.raises(turbid.Refused):
        turbid.run(SCALAR, set={"seed": -1}, out=tmp_path / "p", ranks=2)
    assert capsys.readouterr().err == ""


def test_a_run_is_read_while_it_goes_on(tmp_path):
    seen = []

    def look(progress):
        run = turbid.open(tmp_path / "live")
        frames = run.frames
        seen.append((len(frames), run.viscosity.relative, len(run.series), len(frames[-1].centres) if len(frames) else 0))

    done = turbid.run({**WALLS, "time": {"end": 0.6, "step": 1e-3}}, out=tmp_path / "live", ranks=2, progress=look)
    assert len(seen) > 1 and seen[-1][0] > 1, seen
    assert done.finished and len(done.frames) >= seen[-1][0]
