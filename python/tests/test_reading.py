"""What the package reads is what the files hold."""

import csv
import json
import tomllib

import h5py
import numpy as np
import pytest

import turbid


def stored(run, index):
    numbers = sorted((run.folder / "frames").glob("*.h5"))
    return h5py.File(numbers[index], "r")


def same(found, expected):
    np.testing.assert_array_equal(np.asarray(found), np.asarray(expected))


@pytest.mark.parametrize("name", ["walls", "spheres", "chains", "dry"])
def test_a_frame_holds_what_its_file_holds(name, request):
    run = request.getfixturevalue(name)
    dimension = run.frames[0].dimension
    for index in (0, len(run.frames) // 2, -1):
        frame = run.frames[index]
        with stored(run, index) as file:
            bodies = file["bodies"]
            same(frame.time, file.attrs["time"])
            same(frame.step, file.attrs["step"])
            same(frame.box.size, file.attrs["size"])
            same(frame.centres, bodies["center"][:, :dimension])
            same(frame.radii, bodies["radius"])
            same(frame.velocities, bodies["velocity"][:, :dimension])
            same(frame.spins, bodies["spin"][:, 2] if dimension == 2 else bodies["spin"])
            same(frame.torques, bodies["torque"][:, 2] if dimension == 2 else bodies["torque"])
            same(frame.forces, bodies["force"][:, :dimension])
            same(frame.rotations[:, 0, 1], bodies["rotation"][:, 1])
            same(frame.rotations[:, 1, 0], bodies["rotation"][:, 3])
            same(frame.touches, bodies["contacts"])
            same(frame.bodies["x"], bodies["center"][:, 0])
            same(frame.bodies["velocity_y"], bodies["velocity"][:, 1])
            for column in ("body", "partner", "gap", "force"):
                same(getattr(frame.contacts, column), file["contacts"][column])
                same(frame.contacts.table[column], file["contacts"][column])
            same(frame.contacts.normal, file["contacts/normal"][:, :dimension])
            same(frame.contacts.table["image_x"], file["contacts/image"][:, 0])
            assert len(frame) == file.attrs["body_count"] == len(frame.bodies)


def test_forces_of_friction_lie_in_the_cone_and_across_the_normals(tmp_path):
    scene = {
        "seed": 2,
        "gravity": [0.0, -1.0],
        "domain": {"size": [6.0, 8.0], "y": "walls"},
        "flow": {"model": "none"},
        "bodies": [{"radius": 0.3, "count": 20, "gap": 0.2}],
        "contact": {"model": "inelastic", "friction": 0.5},
        "time": {"end": 6.0, "step": 0.05},
        "output": {"every": 6.0},
    }
    run = turbid.run(scene, out=tmp_path / "rubs", ranks=1, progress=False)
    contacts = run.frames[-1].contacts
    with stored(run, -1) as file:
        same(contacts.friction, file["contacts/friction"][:, :2])
    assert len(contacts) > 10
    size = np.linalg.norm(contacts.friction, axis=1)
    assert (size <= 0.5 * contacts.force * (1 + 1e-9)).all() and size.max() > 0.01
    # forces of the last step, since when normals have turned a little
    assert abs(np.einsum("ij,ij->i", contacts.friction, contacts.normal)).max() < 0.02 * size.max()
    same(contacts.table["friction_x"], contacts.friction[:, 0])


def test_rotations_turn_with_the_spins(walls):
    first, second = walls.frames[0], walls.frames[1]
    angle = np.arctan2(second.rotations[:, 1, 0], second.rotations[:, 0, 0])
    mean = 0.5 * (first.spins + second.spins)
    np.testing.assert_allclose(angle, mean * (second.time - first.time), rtol=0.05, atol=1e-4)


@pytest.mark.parametrize("name", ["walls", "spheres"])
def test_fields_lie_where_the_cells_are(name, request):
    frame = request.getfixturevalue(name).frames[-1]
    with stored(request.getfixturevalue(name), -1) as file:
        raw = {field: np.asarray(values) for field, values in file["fields"].items()}
        cells = file.attrs["cells"]
    dimension, fields = frame.dimension, frame.fields
    assert set(fields) == set(raw)
    same(fields["velocity"], raw["velocity"] if dimension == 3 else raw["velocity"][0, ..., :2])
    same(fields["pressure"], raw["pressure"] if dimension == 3 else raw["pressure"][0])
    assert fields["pressure"].shape == tuple(cells[::-1])
    for axis, count, length in zip("xyz", cells, frame.box.size):
        np.testing.assert_allclose(fields.coordinates[axis], (np.arange(count) + 0.5) * length / count)
    # cells are inside bodies where the nearest image of a centre is less than a radius away
    places = np.stack(np.meshgrid(*[fields.coordinates[axis] for axis in fields.dimensions], indexing="ij")[::-1], axis=-1)
    depth = np.full(places.shape[:-1], -np.inf)
    for centre, radius in zip(frame.centres, frame.radii):
        depth = np.maximum(depth, radius - np.linalg.norm(frame.box.nearest(places - centre), axis=-1))
    assert ((depth > 0) == (fields["inside"] == 1))[np.abs(depth) > 1e-9].all()


def test_frames_are_a_sequence(walls):
    frames = walls.frames
    with h5py.File(walls.folder / "run.h5") as file:
        same(frames.times, file["times"])
    assert [frame.time for frame in frames] == list(frames.times)
    part = frames[-1:2:-2]
    assert [frame.index for frame in part] == list(range(len(frames)))[-1:2:-2]
    same(part.times, frames.times[-1:2:-2])
    assert part[1].index == len(frames) - 3 and part[1:][0].time == part[1].time
    assert frames.at(0.5 * frames.times[1]).index in (0, 1)
    for beyond in (len(frames), -len(frames) - 1):
        with pytest.raises(IndexError, match="has frames 0 to") as raised:
            frames[beyond]
        assert isinstance(raised.value, turbid.TurbidError)


def test_chains_and_cells_are_tied(chains):
    frame = chains.frames[-1]
    with stored(chains, -1) as file:
        same(frame.bonds.bodies.ravel(), file["bonds/body"])
        same(frame.bonds.points.reshape(-1, 2), file["bonds/point"][:, :2])
    assert len(frame.bonds) == 3 * 4 + 24
    apart = np.linalg.norm(frame.bonds.points[:12, 1] - frame.bonds.points[:12, 0], axis=1)
    np.testing.assert_allclose(apart, 0.88, rtol=1e-5)
    [face] = frame.membranes.faces
    assert sorted(frame.membranes.body[face]) == list(range(15, 39))
    assert len(chains.frames[0].contacts.table.columns) > 4


def test_tables_of_chains_and_cells_are_those_of_their_beads(chains):
    table, cells = chains.chains, chains.cells
    times = table.index.unique("time")
    assert len(times) == len(chains.frames) and len(table) == 3 * len(times)
    for time, frame in zip(times, chains.frames):
        for chain in range(3):
            bonds = frame.box.nearest(np.diff(frame.centres[5 * chain : 5 * chain + 5], axis=0))
            row = table.loc[(time, chain)]
            np.testing.assert_allclose(row[["end_to_end_x", "end_to_end_y"]], bonds.sum(axis=0), atol=1e-12)
            assert row["contour_length"] == pytest.approx(np.linalg.norm(bonds, axis=1).sum())
    np.testing.assert_allclose(cells["area"].xs(3, level="cell"), chains.series["enclosed_area"].loc[times], rtol=1e-12)
    assert cells["tread"].iloc[0] == 0.0 and cells["tread"].iloc[-1] < 0.0
    with pytest.raises(turbid.Missing, match="clusters.csv"):
        chains.clusters  # noqa: B018


def test_memories_of_gluey_contacts(dry):
    frame = dry.frames[-1]
    with stored(dry, -1) as file:
        same(frame.contacts.gamma, file["contacts/gamma"])
    assert len(frame.contacts) > 10


def test_tables_are_those_of_the_files(walls):
    with (walls.folder / "series.csv").open() as file:
        rows = list(csv.DictReader(file))
    series = walls.series
    assert series.index.name == "time" and len(series) == len(rows)
    for column in series.columns:
        expected = [float(row[column]) if row[column] else np.nan for row in rows]
        np.testing.assert_array_equal(series[column].to_numpy(float), expected)
    assert walls.summary == json.loads((walls.folder / "summary.json").read_text())
    assert walls.scene == tomllib.loads((walls.folder / "scene.toml").read_text())
    same(walls.bodies[["x", "y"]], [body["center"] for body in walls.summary["bodies"]])
    same(walls.bodies["stresslet_x_y"], [body["stresslet"][0][1] for body in walls.summary["bodies"]])
    series.loc[:, "viscosity"] = 0.0
    assert walls.series["viscosity"].min() > 1.0, "what a user changes stays with the user"


def test_strain_is_that_of_the_series(walls):
    for frame in walls.frames:
        assert frame.strain == pytest.approx(float(walls.series["strain"].loc[frame.time]), abs=1e-14)


def test_the_balance_of_energy_adds_up(tmp_path):
    scene = {
        "title": "falling",
        "gravity": [0.0, -1.0],
        "domain": {"size": [4.0, 4.0], "y": "walls"},
        "flow": {"model": "navier-stokes", "density": 1.0},
        "resolution": {"cells_per_radius": 4},
        "bodies": [{"radius": 0.5, "centers": np.array([[1.0, 2.5]]), "density": 2.0}],
        "time": {"end": 0.2, "step": 0.01},
        "output": {"energy": True},
    }
    energy = turbid.run(scene, out=tmp_path / "falling", ranks=1, progress=False).energy
    gained = energy["kinetic_energy"] - energy["kinetic_energy"].iloc[0]
    assert (energy["work"] - energy["dissipated"] - energy["unbalanced"]).to_numpy() == pytest.approx(gained.to_numpy(), abs=1e-12)
    assert energy["work"].is_monotonic_increasing and abs(energy["unbalanced"].iloc[-1]) < 0.05 * energy["work"].iloc[-1]


def test_forces_of_bodies_with_given_motions(tmp_path):
    scene = {
        "title": "towed",
        "domain": {"size": [4.0, 4.0], "y": "walls"},
        "resolution": {"cells_per_radius": 4},
        "method": {"inverse": "transform"},
        "bodies": [{"radius": 0.5, "centers": np.array([[1.0, 2.0]]), "motion": {"velocity": [1.0, 0.0], "spin": 0.0}}],
        "time": {"end": 0.2},
    }
    run = turbid.run(scene, out=tmp_path / "towed", ranks=1, progress=False)
    assert run.forces["force_x_0"].iloc[-1] == pytest.approx(run.bodies["force_x"][0])
    assert (run.forces["force_x_0"] < 0).all() and len(run.forces) == len(run.series)
    with pytest.raises(turbid.Missing, match="viscosity"):
        run.viscosity  # noqa: B018
    assert run.plot.series("force_x_0").get_ylabel().startswith("force x 0")


def test_scalar_runs_have_an_answer_and_no_frames(scalar):
    assert scalar.summary["scalar"]["conduction"]["conductivity"] == pytest.approx(3.08, rel=1e-2)
    assert len(scalar.frames) == 0 and "conductivity" in scalar._repr_html_()
    with pytest.raises(turbid.Missing, match="series"):
        scalar.series  # noqa: B018
    with pytest.raises(turbid.Missing):
        scalar.frames.at(0.0)
    for place in (0, -1):
        with pytest.raises(IndexError, match="no frames") as raised:
            scalar.frames[place]
        assert isinstance(raised.value, turbid.TurbidError)


def test_an_unfinished_run_gives_what_is_there(unfinished, walls):
    assert not unfinished.finished and "not finished" in repr(unfinished)
    assert len(unfinished.series) == len(walls.series) and len(unfinished.frames) == len(walls.frames)
    assert unfinished.viscosity.relative == pytest.approx(walls.viscosity.relative)
    assert unfinished.viscosity.parts == pytest.approx(walls.viscosity.parts)
    assert len(unfinished.bodies) == len(walls.bodies)
    with pytest.raises(turbid.Missing, match="has not finished; turbid.resume"):
        unfinished.summary  # noqa: B018
    assert "not finished" in unfinished._repr_html_()


def test_what_is_no_run_is_said_to_be_none(tmp_path):
    with pytest.raises(turbid.Missing, match="no folder"):
        turbid.open(tmp_path / "nowhere")
    with pytest.raises(turbid.Missing, match="is no run: it has none of summary.json"):
        turbid.open(tmp_path)


def test_xarray_reads_what_is_asked_for(walls):
    fields = walls.fields
    assert dict(fields.sizes) == {"time": len(walls.frames), "y": 32, "x": 64, "axis": 2}
    frame = walls.frames[2]
    same(fields.velocity.isel(time=2), frame.fields["velocity"])
    same(fields.pressure.isel(time=[0, 2], x=slice(3, 5), y=7), [walls.frames[i].fields["pressure"][7, 3:5] for i in (0, 2)])
    assert float(fields.velocity.sel(axis="x").mean()) == pytest.approx(np.mean([f.fields["velocity"][..., 0].mean() for f in walls.frames]))
    single = frame.to_xarray()
    same(single.centre, frame.centres)
    same(single.vorticity, frame.fields["vorticity"])
    assert float(single.velocity.sel(axis="x").sel(x=8.1, y=3.9, method="nearest")) == frame.fields["velocity"][15, 32, 0]


def test_xarray_in_space(spheres):
    data = spheres.frames[-1].to_xarray()
    assert data.velocity.dims == ("z", "y", "x", "axis") and data.spin.dims == ("body", "axis")
    assert data.attrs["offset"] == spheres.frames[-1].box.offset
