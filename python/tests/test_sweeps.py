"""Sweeps as tables."""

import copy

import pytest

import turbid

DRY = {
    "gravity": [0.0, -1.0],
    "domain": {"size": [4.0, 4.0]},
    "flow": {"model": "none"},
    "bodies": [{"radius": 0.5, "centers": [[2.0, 2.0]]}],
    "time": {"end": 1.0, "step": 0.1},
}


def test_a_sweep_is_a_table_and_its_runs_can_be_opened(tmp_path):
    names = ["settling", "series.kinetic_energy", "last.kinetic_energy"]
    table = turbid.sweep(DRY, {"bodies.0.density": [1, 3.5], "gravity": [[0, -1], [0, -2]]}, quantity=names, out=tmp_path / "out", progress=False)
    assert list(table["bodies.0.density"]) == [1.0, 1.0, 3.5, 3.5] and list(table["gravity"]) == ["[0, -1]", "[0, -2]"] * 2
    assert set(table["settling.over"]) == {"second half"} and set(table["last.kinetic_energy.over"]) == {"end"}
    # of a body that falls freely: mass and the square of gravity
    energy = table["series.kinetic_energy"]
    assert energy[2] / energy[0] == pytest.approx(3.5) and energy[1] / energy[0] == pytest.approx(4.0)
    assert table["fraction_placed"][0] == pytest.approx(0.7853981634 / 16.0)
    runs = turbid.open_sweep(tmp_path / "out", runs=True)
    assert list(runs["settling"]) == list(table["settling"]) and runs["failed"].isna().all()
    kept = turbid.open(runs["folder"][3])
    assert kept.finished and kept.scene["gravity"] == [0, -2]
    assert kept.series["kinetic_energy"].iloc[-1] == table["last.kinetic_energy"][3]
    again = turbid.sweep(copy.deepcopy(DRY), {"bodies.0.density": [1, 3.5], "gravity": [[0, -1], [0, -2]]}, quantity=names, out=tmp_path / "out", progress=False)
    assert again.equals(table), "nothing is measured anew"


def test_what_is_no_sweep_is_said(tmp_path):
    with pytest.raises(turbid.Missing, match="holds no sweep.csv"):
        turbid.open_sweep(tmp_path)
    (tmp_path / "sweep.json").write_text("{")
    with pytest.raises(turbid.Damaged, match="sweep.json is damaged"):
        turbid.open_sweep(tmp_path, runs=True)
    with pytest.raises(turbid.Refused, match="no room|no run came to its end|overlap|fit"):
        turbid.sweep(DRY, {"bodies.0.radius": [5.0]}, out=tmp_path / "none", progress=False)
