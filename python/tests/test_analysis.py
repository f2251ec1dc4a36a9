"""Analyses agree with the program, with exact values or with plain loops."""

import csv
import itertools
import json
from pathlib import Path

import h5py
import numpy as np
import pytest

import turbid
from turbid.statistics import resampled


@pytest.mark.parametrize("name", ["walls", "spheres"])
def test_the_pair_distribution_is_that_of_the_program(name, request):
    run = request.getfixturevalue(name)
    theirs, ours = json.loads((run.folder / "pairs.json").read_text()), run.pair_distribution()
    assert ours.configurations == theirs["configurations"] > 1
    np.testing.assert_allclose(ours.radial.reset_index(), theirs["radial"], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(ours.angular.reset_index(), theirs["angular"], rtol=1e-12)
    assert ours.coordination == pytest.approx(theirs["coordination"])
    np.testing.assert_array_equal(run.pairs.radial.reset_index(), theirs["radial"])


def test_displacements_are_those_of_the_frames(walls):
    frames = walls.steady_frames()
    centres = [frame.centres[:, :2] for frame in frames]
    squares, lags = [], []
    for (one, before), (other, now) in itertools.pairwise(zip(centres, [frame.time for frame in frames], strict=True)):
        steps, strain = other - one, now - before
        steps[:, 0] -= strain * one[:, 1]
        steps[:, 0] -= 16.0 * np.round(steps[:, 0] / 16.0)
        steps[:, 0] -= 0.5 * strain * steps[:, 1]
        squares.append(((steps - steps.mean(axis=0)) ** 2).mean(axis=0))
        lags.append(now - before)
    first = walls.displacements.iloc[0]
    assert first["lag"] == first["strain"] == pytest.approx(np.mean(lags))
    np.testing.assert_allclose(first[["mean_square_x", "mean_square_y"]].astype(float), np.mean(squares, axis=0), rtol=1e-9)


def test_the_structure_factor_is_that_of_the_frames(walls, spheres):
    # between walls along x alone: shells of one wave vector
    frames = walls.steady_frames()
    for number in (1, 5):
        wave = 2 * np.pi * number / 16.0
        powers = [abs(np.exp(1j * wave * frame.centres[:, 0]).sum()) ** 2 / len(frame) for frame in frames]
        row = walls.structure_factor.iloc[number - 1]
        assert row["wave_number"] == pytest.approx(wave) and row["vectors"] == 1
        assert row["structure_factor"] == pytest.approx(np.mean(powers))
    # of a cube those of the sheared lattice of each frame, in shells half as thick as 2 pi over its length
    thickness, shells = np.pi / 5.0, {}
    for frame in spheres.steady_frames():
        for periods in itertools.product(range(3), range(-4, 5), range(-2, 3)):
            if next((number for number in periods if number), 0) <= 0:
                continue
            wave = 2 * np.pi * np.array(periods) / 5.0
            wave[1] -= wave[0] * frame.box.offset / 5.0
            shell = int(np.linalg.norm(wave) / thickness + 0.5)
            shells.setdefault(shell, []).append(abs(np.exp(1j * frame.centres @ wave).sum()) ** 2 / len(frame))
    found = spheres.structure_factor
    numbers = (found["wave_number"] / thickness + 0.5).astype(int)
    for shell in (2, 3):
        assert found["structure_factor"][numbers == shell].item() == pytest.approx(np.mean(shells[shell]))
    assert spheres.summary["structure_factor"]["configurations"] == len(spheres.steady_frames())


def test_the_velocity_autocorrelation_is_that_of_the_frames(walls):
    relative = []
    for frame in walls.steady_frames():
        velocities = frame.velocities[:, :2] - np.outer(frame.centres[:, 1], [1.0, 0.0])
        relative.append(velocities - velocities.mean(axis=0))
    first, second = walls.velocity_autocorrelation.iloc[0], walls.velocity_autocorrelation.iloc[1]
    names = ["autocorrelation_x", "autocorrelation_y"]
    np.testing.assert_allclose(first[names].astype(float), np.mean([(own**2).mean(axis=0) for own in relative], axis=0), rtol=1e-9)
    products = [(one * two).mean(axis=0) for one, two in itertools.pairwise(relative)]
    np.testing.assert_allclose(second[names].astype(float), np.mean(products, axis=0), rtol=1e-9)
    assert first["lag"] == 0


def test_the_map_and_the_pairs_of_two_sizes_add_up(walls, spheres):
    # two rings of the radial distribution have the pairs of one of the map, in two dimensions; those of an ideal gas between walls, of disks of radius 1
    def ideal(inner, outer, start, end):
        rows, squares = (outer**2 - inner**2) / 2, (outer**3 - inner**3) / 3
        return (rows * (end - start) - squares * (np.cos(start) - np.cos(end)) / 6.0) / (16.0 * 6.0)

    radial, turn = walls.pairs.radial["distribution"], np.pi / 18
    for ring, (separation, row) in enumerate(walls.pairs.map.iterrows()):
        inner, outer = 2 * separation - 0.05, 2 * separation + 0.05
        of_map = sum(value * ideal(inner, outer, place * turn, (place + 1) * turn) for place, value in enumerate(row))
        of_radial = sum(radial.iloc[2 * ring + half] * ideal(inner + 0.05 * half, inner + 0.05 * (half + 1), 0.0, np.pi) for half in (0, 1))
        assert of_map == pytest.approx(of_radial, rel=1e-4)
    assert walls.pairs.partial == {}
    assert list(spheres.pairs.partial) == [(0.5, 0.5), (0.5, 0.7), (0.7, 0.7)]


@pytest.mark.parametrize("domain", [{"y": {"lower": [3.0, 0.0], "upper": [0.0, 0.0]}}, {"x": {"lower": [0.0, -2.0], "upper": [0.0, 2.0]}}])
def test_directions_are_those_of_the_shear(domain, tmp_path):
    scene = {
        "title": "crowd between walls",
        "seed": 2,
        "domain": {"size": [8.0, 8.0], **domain},
        "resolution": {"cells_per_radius": 3},
        "method": {"inverse": "transform"},
        "bodies": [{"radius": 0.5, "fraction": 0.4, "gap": 0.01}],
        "contact": {"model": "inelastic"},
        "time": {"end": 0.1},
        "output": {"every": 0.1, "pairs": True, "fields": False},
    }
    run = turbid.run(scene, out=tmp_path / "crowd", ranks=1, progress=False)
    theirs, ours = run.pairs, run.pair_distribution()
    np.testing.assert_allclose(ours.angular["density"], theirs.angular["density"])
    np.testing.assert_allclose(ours.radial["distribution"], theirs.radial["distribution"], atol=1e-12)
    np.testing.assert_allclose(run.series["strain"], run.strain_at(run.series.index), atol=1e-15)
    plain = turbid.pair_distribution(run.steady_frames())
    assert np.abs(plain.angular["density"] - theirs.angular["density"]).max() > 0.1, "the scene tells directions apart"


@pytest.mark.parametrize("offset", [None, 2.3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_near_pairs_are_those_of_all_images_one_by_one(dimension, offset):
    random = np.random.default_rng(3)
    box = turbid.Box(np.array([5.0, 6.0, 4.0][:dimension]), (True, True, False)[:dimension], offset)
    centres = random.random((40, dimension)) * box.size
    reach, expected = 2.6, []
    for first in range(40):
        for second in range(first + 1, 40):
            for row in range(-2, 3):
                for column in range(-4, 5):
                    image = centres[second] - centres[first] + row * box.boxes_along(1) + column * box.boxes_along(0)
                    if np.linalg.norm(image) <= reach:
                        expected.append((first, second, *image))
    found = [np.column_stack(block) for block in turbid.near_pairs(centres, box, reach)]
    both = [np.array(sorted(map(tuple, np.round(np.concatenate(rows), 9)))) for rows in (found, [np.array(expected)])]
    np.testing.assert_allclose(both[0], both[1], atol=1e-8)


def test_a_crowd_is_counted_in_a_second_or_two():
    box = turbid.Box(np.array([200.0, 200.0]), (True, True), 17.0)
    centres = np.random.default_rng(1).random((40_000, 2)) * box.size
    found = sum(len(first) for first, _, _ in turbid.near_pairs(centres, box, 1.0))
    assert found == pytest.approx(0.5 * 40_000**2 * np.pi / box.volume, rel=0.01)


def test_the_nearest_image_is_the_nearest_of_all():
    box = turbid.Box(np.array([5.0, 3.0]), (True, True), 2.4)
    separations = np.random.default_rng(0).random((200, 2)) * 20 - 10
    images = [separations + i * box.boxes_along(0) + j * box.boxes_along(1) for i in range(-8, 9) for j in range(-8, 9)]
    shortest = np.min([np.linalg.norm(image, axis=1) for image in images], axis=0)
    np.testing.assert_allclose(np.linalg.norm(box.nearest(separations), axis=1), shortest, atol=1e-12)
    wrapped = box.wrap(separations)
    assert (wrapped >= 0).all() and (wrapped < box.size).all()
    np.testing.assert_allclose(box.nearest(wrapped - separations), 0, atol=1e-12)


@pytest.mark.parametrize("name", ["walls", "spheres"])
def test_followed_centres_are_those_of_the_checkpoint(name, request):
    run = request.getfixturevalue(name)
    dimension = run.frames[0].dimension
    with h5py.File(run.folder / "checkpoint.h5") as file:
        step = int(file["time"][1])
        centres = np.asarray(file["bodies"]).reshape(len(run.frames[0]), -1)[:, :dimension]
    frame = next(frame for frame in run.frames if frame.step == step)
    followed = frame.unwrapped()
    np.testing.assert_allclose(followed - run.frames[0].centres, centres - run.frames[0].centres, atol=1e-9)
    assert np.abs(followed - frame.centres).max() > 1.0, "nobody has crossed a side"
    paths = run.trajectories()
    assert paths.shape == (len(run.frames), len(frame), dimension)
    np.testing.assert_array_equal(paths[frame.index], followed)
    # frames far apart lead to the same places
    places = [frame.index for frame in run.frames[:: max(len(run.frames) // 4, 1)]]
    np.testing.assert_allclose(run.trajectories(run.frames[:: max(len(run.frames) // 4, 1)]), paths[places], atol=1e-9)


@pytest.mark.parametrize(("name", "axis"), [("walls", "y"), ("walls", "x"), ("spheres", "z"), ("spheres", "y")])
def test_fractions_are_exact(name, axis, request):
    run = request.getfixturevalue(name)
    frame, place = run.frames[-1], "xyz".index(axis)
    profile = turbid.profile([frame], "fraction", axis, bins=7)
    dimension = frame.dimension
    solid = (np.pi * frame.radii**2 if dimension == 2 else 4 / 3 * np.pi * frame.radii**3).sum()
    assert profile.mean.mean() * frame.box.volume == pytest.approx(solid)
    # by many thin layers
    layers = (np.arange(14000) + 0.5) / 14000 * frame.box.size[place]
    apart = np.abs(layers[:, None] - frame.centres[:, place])
    if frame.box.periodic[place]:
        apart = np.minimum(apart, frame.box.size[place] - apart)
    half = np.sqrt(np.maximum(frame.radii**2 - apart**2, 0.0))
    cut = (2 * half if dimension == 2 else np.pi * half**2).sum(1) / (frame.box.volume / frame.box.size[place])
    np.testing.assert_allclose(profile.mean, cut.reshape(7, -1).mean(1), atol=1e-5)
    np.testing.assert_allclose(profile.mean, turbid.profile([frame], "inside", axis, bins=7).mean, atol=0.02)
    assert np.isnan(profile.error).all()


def test_the_velocity_profile_is_the_mean_of_the_cells(walls):
    frames = walls.frames[-9:]
    profile = walls.profile("velocity", axis="y", frames=frames)
    cells = np.array([frame.fields["velocity"].mean(axis=1) for frame in frames])
    np.testing.assert_allclose(profile.mean, cells.mean(0))
    np.testing.assert_array_equal(profile.positions, walls.frames[0].fields.coordinates["y"])
    assert profile.frames == 9 and (profile.error >= cells.std(0, ddof=1) / 3 - 1e-12).all()
    coarse = walls.profile("velocity", bins=8, frames=frames)
    np.testing.assert_allclose(coarse.mean, profile.mean.reshape(8, 4, 2).mean(1))
    assert list(profile.table) == ["velocity_x", "velocity_x_error", "velocity_y", "velocity_y_error"]
    assert profile.mean[0, 0] < -3 and profile.mean[-1, 0] > 3, "walls drag the fluid along"


@pytest.mark.parametrize("name", ["walls", "spheres"])
def test_velocities_of_bodies_are_those_of_the_flow_inside(name, request):
    frame = request.getfixturevalue(name).frames[-1]
    fields, middle = frame.fields, frame.dimension == 3
    solid = turbid.profile([frame], "body_velocity", "y", bins=4).mean
    inside = (fields["inside"] == 1)[..., None]
    along = fields.dimensions.index("y")
    for number, part in enumerate(np.array_split(np.arange(fields["inside"].shape[along]), 4)):
        velocity, here = (np.take(values, part, axis=along) for values in (fields["velocity"], inside))
        there = (velocity * here).reshape(-1, frame.dimension).sum(0) / here.sum()
        np.testing.assert_allclose(solid[number], there, atol=0.5 if middle else 0.25)


def test_rotation_counts_in_velocities_of_bodies():
    class Frame:
        box = turbid.Box(np.array([10.0, 10.0, 10.0]), (True, True, True))
        dimension, time, has_fields = 3, 0.0, False
        centres, radii = np.array([[5.0, 5.0, 5.0]]), np.array([2.0])
        velocities, spins = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 3.0]])

    found = turbid.profile([Frame()], "body_velocity", "y", bins=10)  # type: ignore[list-item]
    # of a ball from 1 to 2: first moment over volume, which are pi (4 1.5 - 15/4) and pi (4 - 7/3)
    height = (4 * 1.5 - 15 / 4) / (4 - 7 / 3)
    np.testing.assert_allclose(found.mean[6], [1.0 - 3.0 * height, 0.0, 0.0], atol=1e-12)
    assert np.isnan(found.mean[0]).all()


def test_wrong_choices_are_named(walls):
    with pytest.raises(ValueError, match="must be one of velocity, fraction"):
        walls.profile("speed")
    with pytest.raises(ValueError, match="axis = 'z': must be one of x, y"):
        walls.profile("velocity", axis="z")
    with pytest.raises(turbid.Missing, match="no column end_to_end"):
        walls.mean("end_to_end")


def correlated(count, memory, seed=5):
    random = np.random.default_rng(seed)
    keep, value, samples = np.exp(-1 / memory), 0.0, []
    for _ in range(count):
        value = keep * value + np.sqrt(1 - keep**2) * random.standard_normal()
        samples.append(value)
    return np.array(samples)


def test_intervals_of_correlated_samples_hold_the_mean():
    means = [turbid.steady_mean(np.arange(2000.0), correlated(2000, 20.0, seed)) for seed in range(100)]
    assert all(means) and 90 <= sum(abs(mean.value) <= mean.half_width for mean in means) <= 99
    table = turbid.blocking(correlated(20000, 8.0))
    true = 1.96 * np.sqrt(2 * 8.0 / 20000)
    assert table["half_width"].iloc[0] < 0.4 * true
    assert table["half_width"].loc[256] == pytest.approx(true, rel=0.4)
    error = turbid.standard_error(np.stack([correlated(20000, 8.0), np.zeros(20000)], axis=1))
    assert 1.96 * error[0] == pytest.approx(true, rel=0.6) and error[1] == 0


def test_a_start_is_left_out_and_an_unsteady_curve_has_no_mean():
    x = np.linspace(0, 10, 1000)
    noise = np.random.default_rng(2).standard_normal(1000) * 0.01
    mean = turbid.steady_mean(x, 2.0 + np.where(x < 1.0, 1.0 - x, 0.0) + noise)
    assert mean is not None and 0.5 < mean.start < 1.6 and mean.value == pytest.approx(2.0, abs=3e-3)
    assert turbid.steady_mean(x, x + noise) is None
    assert turbid.steady_mean(x[:20], noise[:20]) is None


CURVES = Path(__file__).parents[2] / "tests/data/viscosity"


def test_means_of_windows_of_runs_are_those_of_the_program():
    """The program's tests read the same file."""
    with (CURVES / "windows.csv").open() as file:
        rows = list(csv.DictReader(file))
    curves = {name: np.loadtxt(CURVES / f"{name}.txt") for name in {row["curve"] for row in rows}}
    for row in rows:
        places = np.arange(int(row["from"]), int(row["to"]))
        mean = turbid.steady_mean(0.1 * places, curves[row["curve"]][places], 20.0)
        if not row["mean"]:
            assert mean is None, row
            continue
        assert mean is not None and mean.blocks == int(row["blocks"]), row
        expected = [float(row[name]) for name in ("mean", "half_width", "start")]
        np.testing.assert_allclose([mean.value, mean.half_width, mean.start], expected, rtol=1e-12)


def test_a_curve_without_a_mean_says_why():
    x = np.arange(400) / 100
    for y, least, reason in [
        (x, 0.0, "it still drifts"),
        (np.ones(400), 10.0, "its steady part is too short to estimate its fluctuations"),
        (np.cos(1.7 * x), 0.0, "its fluctuations last too long"),
    ]:
        assert turbid.steady_mean(x, y, least) is None and turbid.shortage(x, y, least) == reason
    assert turbid.shortage(x[:20], x[:20]) == "it has too few steps"
    assert turbid.shortage(x, np.sin(50 * x)) is None


def test_resampling_keeps_the_integral():
    x = np.sort(np.random.default_rng(1).random(30))
    y = x**2
    whole = (np.diff(x) * 0.5 * (y[1:] + y[:-1])).sum() / (x[-1] - x[0])
    assert resampled(x, y, 7).mean() == pytest.approx(whole)


@pytest.fixture(scope="module")
def long(folder):
    """Two disks in a box that is sheared for long enough to have a mean."""
    scene = {
        "title": "two disks for long",
        "domain": {"size": [4.0, 4.0]},
        "flow": {"drive": {"shear_rate": 1.0, "periodic": "sheared"}},
        "resolution": {"cells_per_radius": 3},
        "method": {"inverse": "transform"},
        "bodies": [{"radius": 0.5, "centers": [[1.0, 1.2], [3.0, 2.6]]}],
        "contact": {"model": "inelastic"},
        "time": {"end": 40.0},
        "output": {"every": 1.0, "fields": False, "pairs": True},
    }
    return turbid.run(scene, out=folder / "long", ranks=1, progress=False)


def test_the_mean_viscosity_is_that_of_the_program(long):
    theirs = long.summary["viscosity"]["mean"]
    assert theirs is not None, "choose a scene with a mean"
    found = long.viscosity
    assert (found.mean, found.interval, found.blocks) == (theirs["relative"], tuple(theirs["interval"]), theirs["blocks"])
    assert sum(found.mean_parts.values()) == pytest.approx(found.mean)
    series = long.series
    ours = turbid.steady_mean(series["strain"], series["viscosity"], 20.0)
    assert ours is not None
    np.testing.assert_allclose(ours.interval, theirs["interval"], rtol=1e-9)
    np.testing.assert_allclose([ours.start, ours.end], theirs["strains"], rtol=1e-9)
    assert ours.blocks == theirs["blocks"]
    of_series = turbid.Viscosity.of_series(series)
    assert of_series is not None and of_series.mean_parts == pytest.approx(found.mean_parts)
    assert long.mean("viscosity").value == pytest.approx(ours.value)
    quantities = long.quantities
    assert (quantities.loc["viscosity", ["mean", "half_width"]].astype(float) == [found.mean, found.half_width]).all()
    for name in ["first_normal_difference", "particle_pressure_contact", "body_velocity_x"]:
        mean = turbid.steady_mean(series["strain"], series[name], 20.0)
        assert quantities.loc[name, "last"] == series[name].iloc[-1]
        assert quantities.loc[name, "mean"] == pytest.approx(mean.value if mean else np.nan, rel=1e-9, abs=1e-12, nan_ok=True)
        assert quantities.loc[name, "half_width"] == pytest.approx(mean.half_width if mean else np.nan, rel=1e-9, nan_ok=True)
    rheology = long.rheology
    assert rheology.loc["viscosity", "value"] == pytest.approx(found.mean) and rheology.loc["viscosity", "half_width"] == pytest.approx(found.half_width)
    assert {"first_normal_difference", "viscosity_hydrodynamic"} <= set(rheology.index) and "smallest_gap" not in rheology.index
    assert quantities.loc["shear_rate", "unit"] == "1/time"
    assert quantities.loc["shear_rate", "mean"] == pytest.approx(long.shear.rate, rel=1e-12)
    assert long.pair_distribution().configurations == long.summary["pairs"]["configurations"]
    assert "±" in long._repr_html_()


def test_a_shear_that_oscillates_or_follows_a_stress(folder):
    scene = {
        "domain": {"size": [4.0, 4.0], "y": "walls"},
        "flow": {"drive": {"shear_rate": {"amplitude": 0.2, "frequency": 0.5}}},
        "resolution": {"cells_per_radius": 3},
        "method": {"inverse": "transform"},
        "bodies": [{"radius": 0.5, "centers": [[1.0, 1.2], [3.0, 2.6]]}],
        "contact": {"model": "inelastic"},
        "time": {"end": 2.0},
        "output": {"every": 0.5, "fields": False},
    }
    run = turbid.run(scene, out=folder / "oscillation", ranks=1, progress=False)
    assert run.shear is not None and not run.shear.steady and list(run.shear.flow) == [1.0, 0.0]
    assert run.strain_at(0.5) == pytest.approx(0.2, rel=1e-2) and run.strain_at([1.0, 2.0]) == pytest.approx(0.0, abs=1e-3)
    series, found = run.series, run.oscillation
    assert found["cycles"] == 1 and found["phase"] == pytest.approx(90.0, abs=0.1)
    viscosity = float(series["viscosity"].mean())
    assert found["loss_modulus"]["value"] == pytest.approx(viscosity * np.pi, rel=1e-2)
    assert series["wall_stress"].to_numpy() == pytest.approx(series["shear_stress"].to_numpy(), rel=1e-4, abs=1e-4)
    assert run.viscosity.mean is None and run.frames[1].strain == pytest.approx(0.2, rel=1e-2)
    pushed = turbid.run(scene, out=folder / "stress", set={"flow.drive": {"shear_stress": 2.0}, "time.end": 1.0}, ranks=1, progress=False)
    assert pushed.series["shear_stress"].to_numpy() == pytest.approx(2.0, rel=1e-4)
    assert pushed.strain_at(1.0) == pytest.approx(pushed.series["strain"].iloc[-1])
    with pytest.raises(turbid.Missing, match="oscillation"):
        _ = pushed.oscillation


def test_a_run_that_is_too_short_says_why_it_has_no_mean(walls):
    assert walls.viscosity.mean is None
    assert walls.viscosity.reason.startswith("the run is too short for a mean, it") and "{" not in walls.viscosity.reason
    with pytest.warns(UserWarning, match="viscosity of .* has no mean: the run is too short, it"):
        assert walls.mean("viscosity") is None


def test_frames_that_count_begin_where_the_steady_part_does(long):
    assert long.steady_frames().times[0] >= long.viscosity.strains[0] - 1e-9 > long.steady_frames().times[0] - 1.1
