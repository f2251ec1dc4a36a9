"""The picture of a frame: bodies, what ties them, and the flow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import Colormap, Normalize

from ..box import Floats, Integers
from ..errors import Invalid, Missing
from .charts import norm_of
from .style import AROUND_ZERO, BODY, BOND, DARK, EDGE, FORCE, GROWING, WALL, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..frame import Frame

#: What bodies and fields can be coloured by.
COLOUR_CHOICES = ("speed", "velocity_x", "velocity_y", "velocity_z", "spin", "contacts", "radius", "chain", "pressure", "vorticity", None)

_SIGNED = ("velocity_x", "velocity_y", "velocity_z", "spin", "pressure", "vorticity")
_OF_FIELDS = ("pressure", "vorticity")
_TIES = ("contacts", "chain", "radius")
_WIDEST_LINE = 4.0


class Picture:
    """Draws a frame as it is seen along an axis: the whole of it, or what a plane cuts."""

    def __init__(self, frame: Frame, axes: Axes | None, view: str, cut: float | None) -> None:
        self.frame = frame
        names = "xyz"[: frame.dimension]
        if len(view) != 2 or view[0] == view[1] or not set(view) <= set(names):
            raise Invalid(f"view = {view!r}: must name two of the axes {', '.join(names)}")
        self.view = view
        self.plane = [names.index(axis) for axis in view]
        self.depth = next(axis for axis in range(3) if axis not in self.plane) if frame.dimension == 3 else None
        if cut is not None and self.depth is None:
            raise Invalid("cut: a frame in 2D has no depth to cut")
        self.cut = cut
        size = frame.box.size[self.plane]
        self.axes = axes if axes is not None else _new_axes(float(size[0]), float(size[1]))

    def draw(self, colour: str | npt.ArrayLike | None, contacts: bool, bonds: bool, flow: bool, streamlines: bool) -> Axes:
        """All of it, with a colour bar and the time."""
        frame = self.frame
        per_body = colour if colour is not None and not isinstance(colour, str) else None
        name = colour if isinstance(colour, str) else None
        if name is not None and name not in COLOUR_CHOICES:
            raise Invalid(f"colour = {name!r}: must be one of {', '.join(str(choice) for choice in COLOUR_CHOICES)}, or a number for each body")
        values = _of_bodies(frame, name) if per_body is None else np.asarray(per_body, dtype=float)
        if values is not None and values.shape != (len(frame),):
            raise Invalid(f"colour: takes a number for each of {len(frame)} bodies, not an array of shape {values.shape}")
        field = self._field(name) if flow and self._shows_flow() else None
        if name in _OF_FIELDS and field is None:
            raise Missing(f"{frame.path} holds no {name} to colour a plane of; in 3D give cut=")
        fluid = None if field is None else field[self._slice(frame.fields["inside"]) < 0.5]
        shown = [numbers for numbers in (values, fluid) if numbers is not None]
        norm = norm_of(np.concatenate(shown), name in _SIGNED) if shown else Normalize()
        colours = plt.get_cmap(AROUND_ZERO if name in _SIGNED else GROWING)
        if name == "chain" and values is not None:
            colours, norm = plt.get_cmap("tab20"), Normalize(0, 20)
            values = np.where(values >= 0, values % 20, np.nan)
        mappable = self._draw_field(field, colours, norm)
        bodies = self._draw_bodies(values, colours, norm, name)
        if streamlines and self._shows_flow():
            self._draw_streamlines("black" if name in _SIGNED else "white")
        if bonds and self.cut is None:
            self._draw_bonds()
        if contacts and self.cut is None:
            self._draw_contacts()
        self._finish()
        bar = bodies if values is not None else mappable
        if bar is not None and name != "chain":
            beyond = "both" if name in _SIGNED and len(shown) and np.abs(np.concatenate(shown)).max(initial=0.0) > norm.vmax else "neither"
            self.axes.figure.colorbar(bar, ax=self.axes, label=_label(name), shrink=0.8, pad=0.02, extend=beyond)
        return self.axes

    def _shows_flow(self) -> bool:
        return self.frame.has_fields and (self.depth is None or self.cut is not None)

    def _slice(self, field: Floats) -> Floats:
        """A field in the plane, rows upwards."""
        names = list(self.frame.fields.dimensions)
        if self.depth is not None and self.cut is not None:
            axis = "xyz"[self.depth]
            place = int(np.clip(self.cut / self.frame.fields.spacing[self.depth], 0, field.shape[names.index(axis)] - 1))
            field = np.take(field, place, axis=names.index(axis))
            names.remove(axis)
        return field if names == [self.view[1], self.view[0]] else np.swapaxes(field, 0, 1)

    def _field(self, name: str | None) -> Floats | None:
        fields = self.frame.fields
        if name == "speed":
            return self._slice(np.linalg.norm(fields["velocity"], axis=-1))
        if name in ("velocity_x", "velocity_y", "velocity_z"):
            return self._slice(fields["velocity"][..., "xyz".index(name[-1])])
        if name == "vorticity" and "vorticity" in fields and self.frame.dimension == 3 and self.depth is not None:
            return self._slice(fields["vorticity"][..., self.depth])
        return self._slice(fields[name]) if name in _OF_FIELDS and name in fields else None

    def _draw_field(self, field: Floats | None, colours: Colormap, norm: Normalize) -> Any:
        if field is None:
            return None
        size = self.frame.box.size[self.plane]
        return self.axes.imshow(field, origin="lower", extent=(0, size[0], 0, size[1]), cmap=colours, norm=norm, interpolation="bilinear", zorder=0)

    def _draw_bodies(self, values: Floats | None, colours: Colormap, norm: Normalize, name: str | None) -> Any:
        frame = self.frame
        numbers, places = frame.box.images(frame.centres, float(frame.radii.max(initial=0.0)))
        radii = frame.radii[numbers]
        if self.depth is not None:
            below = places[:, self.depth] - (self.cut or 0.0)
            if self.cut is not None:
                kept = np.abs(below) < radii
                radii = np.sqrt(np.maximum(radii**2 - below**2, 0.0))
            else:
                kept = (places[:, self.depth] >= 0) & (places[:, self.depth] <= frame.box.size[self.depth])
            order = np.argsort(places[:, self.depth])
            order = order[kept[order]]
            numbers, places, radii = numbers[order], places[order], radii[order]
        width = 2 * radii
        drawn = EllipseCollection(width, width, 0 * width, units="xy", offsets=places[:, self.plane], offset_transform=self.axes.transData, zorder=2)
        # dark on dark is not seen
        drawn.set_edgecolor("white" if self.axes.images and name not in _SIGNED else EDGE)
        drawn.set_linewidth(0.9 if len(frame) < 1000 else 0.2)
        if values is None:
            drawn.set_facecolor(DARK if name in _OF_FIELDS else BODY)
        else:
            colours = colours.with_extremes(bad=BODY)
            drawn.set(cmap=colours, norm=norm)
            drawn.set_array(np.ma.masked_invalid(self._of_images(values, name, numbers, places)))

        self.axes.add_collection(drawn)
        return drawn

    def _of_images(self, values: Floats, name: str | None, numbers: Integers, places: Floats) -> Floats:
        """A number for each image: where images slide, those above move faster."""
        frame = self.frame
        if not frame.box.offset_rate or name not in ("speed", "velocity_x"):
            return values[numbers]
        rows = np.round((places[:, 1] - frame.centres[numbers, 1]) / frame.box.size[1])
        velocities = frame.velocities[numbers]
        velocities[:, 0] += rows * frame.box.offset_rate
        return np.linalg.norm(velocities, axis=1) if name == "speed" else velocities[:, 0]

    def _draw_streamlines(self, colour: str) -> None:
        fields = self.frame.fields
        velocity = self._slice(fields["velocity"])
        across, up = (fields.coordinates[axis] for axis in self.view)
        lines = self.axes.streamplot(
            across, up, velocity[..., self.plane[0]], velocity[..., self.plane[1]], color=colour, linewidth=0.6, density=1.2, arrowsize=0.6, zorder=1
        )
        lines.lines.set_alpha(0.7)

    def _draw_bonds(self) -> None:
        points = self.frame.bonds.points
        if len(points):
            lines = self._with_images(points)
            self.axes.add_collection(LineCollection(list(lines), colors=BOND, linewidths=1.2, zorder=3))

    def _draw_contacts(self) -> None:
        """A line from centre to centre, as wide as the force is large."""
        found, frame = self.frame.contacts, self.frame
        bearing = found.force > 0
        if not bearing.any():
            return
        start, radius = frame.centres[found.body[bearing]], frame.radii[found.body[bearing]]
        partner = found.partner[bearing]
        reach = np.where(partner >= 0, radius + found.gap[bearing] + frame.radii[np.maximum(partner, 0)], radius + found.gap[bearing])
        lines = self._with_images(np.stack([start, start + reach[:, None] * found.normal[bearing]], axis=1))
        widths = np.tile(
            _WIDEST_LINE * np.minimum(found.force[bearing] / np.quantile(found.force[bearing], 0.95), 1.5), len(lines) // int(bearing.sum())
        )
        self.axes.add_collection(LineCollection(list(lines), colors=FORCE, linewidths=np.maximum(widths, 0.3), zorder=4, capstyle="round"))

    def _with_images(self, lines: Floats) -> Floats:
        """Lines and their images in the boxes around, of which the picture shows what is in the box."""
        box = self.frame.box
        around = [lines]
        for axis in range(box.dimension):
            if box.periodic[axis]:
                around = [moved for part in around for moved in (part, part + box.boxes_along(axis), part - box.boxes_along(axis))]
        whole: Floats = np.concatenate(around)[..., self.plane]
        return whole

    def _finish(self) -> None:
        frame, axes = self.frame, self.axes
        size = frame.box.size[self.plane]
        axes.set(
            xlim=(0, size[0]),
            ylim=(0, size[1]),
            aspect="equal",
            xlabel=f"{self.view[0]} [units of the scene]",
            ylabel=f"{self.view[1]} [units of the scene]",
        )
        for side, along in zip((("left", "right"), ("bottom", "top")), self.plane):
            periodic = frame.box.periodic[along]
            for name in side:
                axes.spines[name].set(linewidth=0.8 if periodic else 2.5, color=WALL, linestyle=":" if periodic else "-")
        strain = frame.strain
        title = f"time {frame.time:.4g}" + (f", strain {abs(strain):.4g}" if strain is not None else "")
        if self.depth is not None:
            axis = "xyz"[self.depth]
            title += f", cut at {axis} = {self.cut:g}" if self.cut is not None else f", seen along {axis}"
        axes.set_title(title, fontsize="medium")


def _new_axes(width: float, height: float) -> Axes:
    across = float(np.clip(4.4 * width / height, 3.5, 6.6))
    _, axes = plt.subplots(figsize=(across + 1.2, float(np.clip(across * height / width, 2.0, 8.0)) + 0.8), layout="constrained")
    return axes


def _label(name: str | None) -> str:
    if name == "speed":
        return label("speed")
    return label(name) if name and name != "contacts" else ("contacts" if name else "")


def _of_bodies(frame: Frame, name: str | None) -> Floats | None:
    """A number for each body; nothing where a field alone has the colour."""
    if name is None or name in _OF_FIELDS:
        return None
    if name == "speed":
        return np.linalg.norm(frame.velocities, axis=1)
    if name.startswith("velocity_"):
        if name[-1] not in "xyz"[: frame.dimension]:
            raise Invalid(f"colour = {name!r}: the frame is in 2D")
        return frame.velocities[:, "xyz".index(name[-1])]
    if name == "spin":
        return frame.spins if frame.dimension == 2 else np.linalg.norm(frame.spins, axis=1)
    if name == "contacts":
        return frame.touches.astype(float)
    if name == "radius":
        return frame.radii
    chains = np.full(len(frame), np.nan)
    chains[frame.bonds.bodies] = frame.bonds.chain[:, None]
    return chains
