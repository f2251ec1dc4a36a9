"""Plots show what they should, labelled, on the axes that are given."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import EllipseCollection, LineCollection

import turbid


def bodies(axes):
    return next(drawn for drawn in axes.collections if isinstance(drawn, EllipseCollection))


def test_charts_are_labelled_and_hold_the_data(walls):
    axes = walls.plot.viscosity()
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), walls.series["viscosity"])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("strain", "relative viscosity")
    axes = walls.plot.series(["contacts", "iterations"], against="strain")
    assert [line.get_label() for line in axes.lines] == ["contacts that bear a force", "iterations in the step"]
    axes = walls.plot.profile("velocity", components="x")
    assert axes.get_xlabel() == "velocity x [units of the scene]" and axes.get_ylim() == (0, 8)
    axes = walls.plot.pair_distribution()
    np.testing.assert_allclose(axes.patches[0].get_data().values, walls.pairs.radial["distribution"])
    assert walls.plot.directions().get_xlabel().startswith("direction")
    axes = walls.plot.structure_factor()
    np.testing.assert_allclose(axes.lines[0].get_xydata()[:, 1], walls.structure_factor["structure_factor"])
    axes = walls.plot.velocity_autocorrelation()
    assert axes.lines[0].get_xydata()[0, 1] == 1 and [text.get_text() for text in axes.get_legend().get_texts()] == ["along x", "along y"]
    drawn = walls.plot.pair_map().collections[0]
    assert drawn.get_array().size == 2 * walls.pairs.map.size
    with pytest.raises(turbid.Missing, match="no column bogus"):
        walls.plot.series("bogus")


def test_the_band_of_a_mean_is_where_the_mean_is():
    import pandas as pd

    from turbid.plotting.charts import viscosity_chart

    series = pd.DataFrame({"strain": np.linspace(0, 2, 50), "viscosity": 2.0, "viscosity_hydrodynamic": 1.5, "viscosity_contact": 0.5})
    found = turbid.Viscosity(2.0, {"hydrodynamic": 1.5, "contact": 0.5}, mean=2.0, interval=(1.9, 2.1), strains=(0.5, 2.0), blocks=9)
    axes = viscosity_chart(series, found, None, parts=True)
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["viscosity", "part: hydrodynamic", "part: contact", "left out of the mean", "mean 2 ± 0.1, 95 %"]


def test_a_frame_is_drawn_as_it_is(walls, tmp_path):
    figure, axes = plt.subplots()
    frame = walls.frames[-1]
    assert walls.plot.frame(frame, colour="speed", contacts=True, streamlines=True, axes=axes) is axes
    drawn = bodies(axes)
    numbers, places = frame.box.images(frame.centres, frame.radii.max())
    np.testing.assert_allclose(drawn.get_offsets(), places)
    np.testing.assert_allclose(drawn.get_array()[: len(frame)], np.linalg.norm(frame.velocities, axis=1))
    assert len(axes.images) == 1 and axes.get_title().startswith("time 0.3, strain")
    assert figure.axes[1].get_ylabel() == "speed [units of the scene]"
    figure.savefig(tmp_path / "frame.png")
    assert (tmp_path / "frame.png").stat().st_size > 10_000


@pytest.mark.parametrize("colour", ["velocity_x", "spin", "contacts", "radius", "chain", "pressure", "vorticity", None])
def test_every_colour_can_be_drawn(walls, colour):
    walls.plot.frame(0, colour=colour).figure.canvas.draw()


def test_a_number_for_each_body_is_a_colour(walls):
    values = np.arange(len(walls.frames[0]), dtype=float)
    np.testing.assert_array_equal(bodies(walls.plot.frame(0, colour=values)).get_array()[: len(values)], values)
    with pytest.raises(ValueError, match="takes a number for each of"):
        walls.plot.frame(0, colour=values[:-1])
    with pytest.raises(ValueError, match="must be one of speed"):
        walls.plot.frame(0, colour="red")


def test_images_that_slide_have_their_own_speed(spheres):
    frame = spheres.frames[-1]
    drawn = bodies(spheres.plot.frame(-1, colour="velocity_x"))
    places, speeds = np.asarray(drawn.get_offsets()), np.asarray(drawn.get_array())
    # the drawn velocity follows the shear above the box too
    above = places[:, 1] > frame.box.size[1]
    assert above.any() and speeds[above].min() > 0.7 * frame.box.offset_rate


def test_a_cut_through_spheres_is_circles(spheres):
    frame = spheres.frames[-1]
    drawn = bodies(spheres.plot.frame(-1, view="xz", cut=2.5))
    below = np.abs(frame.centres[:, 1] - 2.5)
    radii = np.sqrt(frame.radii[below < frame.radii] ** 2 - below[below < frame.radii] ** 2)
    assert set(np.round(radii, 9)) <= set(np.round(drawn._widths, 9))
    with pytest.raises(turbid.Missing, match="give cut="):
        spheres.plot.frame(-1, colour="pressure")
    with pytest.raises(ValueError, match="view"):
        spheres.plot.frame(-1, view="xw")


def test_chains_and_contacts_are_lines(chains, dry):
    lines = [drawn for drawn in chains.plot.frame(colour="chain").collections if isinstance(drawn, LineCollection)]
    assert len(lines) == 1 and len(lines[0].get_segments()) == 3 * len(chains.frames[-1].bonds)
    axes = dry.plot.frame(colour=None, contacts=True)
    [lines] = [drawn for drawn in axes.collections if isinstance(drawn, LineCollection)]
    assert len(lines.get_segments()) == 3 * int((dry.frames[-1].contacts.force > 0).sum())


def test_nothing_at_rest_is_scaled_to_noise(dry):
    from turbid.plotting.charts import norm_of

    norm = norm_of(np.full(5, 2.0) + 1e-13, False)
    assert norm.vmin < 1.5 and norm.vmax > 2.5
