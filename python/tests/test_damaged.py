"""Files that are damaged, and arguments of the analysis that cannot be used."""

import shutil

import numpy as np
import pytest

import turbid


@pytest.fixture
def copy(walls, tmp_path):
    shutil.copytree(walls.folder, tmp_path / "copy")
    return turbid.open(tmp_path / "copy")


@pytest.mark.parametrize(
    ("name", "damage", "read"),
    [
        ("series.csv", lambda data: data[: len(data) // 2].rsplit(b",", 3)[0] + b"\n" + data[len(data) // 2 :], lambda run: run.series),
        ("series.csv", lambda data: data.replace(b"time", b"hour"), lambda run: run.series),
        ("summary.json", lambda data: data[:100], lambda run: run.summary),
        ("summary.json", lambda data: b"[]", lambda run: run.summary),
        ("summary.json", lambda data: b"\xff\xfe", lambda run: run.summary),
        ("scene.toml", lambda data: b"a = = b", lambda run: run.scene),
        ("pairs.json", lambda data: b"{}", lambda run: run.pairs),
        ("run.h5", lambda data: data[:512], lambda run: run.frames),
        ("run.h5", lambda data: b"nothing", lambda run: run.frames),
        ("frames/000000.h5", lambda data: data[:2000], lambda run: run.frames[0].centres),
        ("frames/000000.h5", lambda data: b"", lambda run: run.frames[0].fields["velocity"]),
    ],
)
def test_a_damaged_file_is_named(name, damage, read, copy):
    path = copy.folder / name
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(turbid.TurbidError) as caught:
        read(copy)
    assert name.split("/")[-1] in str(caught.value) or isinstance(caught.value, turbid.Missing), caught.value
    if isinstance(caught.value, turbid.Damaged):
        assert caught.value.path == path and "force=True" in str(caught.value)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda run: run.profile("velocity", bins=0), "bins = 0: must be at least 1"),
        (lambda run: run.profile("velocity", bins=2.5), "bins = 2.5: must be a whole number"),
        (lambda run: run.profile("weight"), "quantity = 'weight': must be one of"),
        (lambda run: run.profile("velocity", axis=1), "axis = 1: must be one of x, y"),
        (lambda run: run.pair_distribution(width=0), "width = 0: must be above 0"),
        (lambda run: run.pair_distribution(width="a"), "width = 'a': must be a number above 0"),
        (lambda run: run.pair_distribution(farthest=0.5), "farthest = 0.5: must be above 1"),
        (lambda run: run.frames.at("end"), "time = 'end': must be a number"),
        (lambda run: run.animate(width=0), "width = 0: must be at least 1"),
        (lambda run: turbid.steady_mean([0.0, 1.0, 2.0], [1.0, 2.0]), "are 3 and 2 numbers; give a value for each abscissa"),
        (lambda run: turbid.steady_mean([0.0, 2.0, 1.0], [1.0, 2.0, 3.0]), "must be numbers that grow"),
        (lambda run: turbid.steady_mean(np.zeros((2, 2)), [1.0, 2.0]), r"not an array of shape \(2, 2\)"),
        (lambda run: turbid.blocking(["a"]), "samples: must be a list or an array of numbers"),
        (lambda run: turbid.sweep("a.toml", {}), "vary: names no key"),
        (lambda run: turbid.sweep("a.toml", {"seed": 3}), "seed = 3: must be a list of values"),
        (lambda run: turbid.sweep("a.toml", {"seed": [1]}, keep="some"), "keep = 'some': must be one of series, all, nothing"),
        (lambda run: turbid.sweep("a.toml", {"seed": [1]}, seeds=0), "seeds = 0: must be at least 1"),
        (lambda run: turbid.sweep("a.toml", {"seed": [1]}, quantity=[]), r"quantity = \[\]: must be a name or a list of names"),
    ],
)
def test_arguments_that_cannot_be_used_say_what_to_give(call, message, walls):
    with pytest.raises(turbid.Invalid, match=message):
        call(walls)
