"""Reads frames with h5py and with VTK's readers of XDMF and VTKHDF, and compares them with what the writer must have written.

usage: independent_reader.py FOLDER DIMENSION FRAMES
       independent_reader.py FOLDER run              a run of the program, under way or finished
"""

import hashlib
import json
import pathlib
import sys

import h5py
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXdmf2 import vtkXdmfReader

BODIES = 7
EXACT = 1e-12


def same(found, expected, what):
    found, expected = numpy.asarray(found), numpy.asarray(expected)
    assert found.shape == expected.shape, f"{what}: shape {found.shape} instead of {expected.shape}"
    worst = numpy.abs(found - expected).max(initial=0.0)
    assert worst <= EXACT * max(1.0, numpy.abs(expected).max(initial=0.0)), f"{what}: off by {worst}"


def in_space(vectors):
    return numpy.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def expected_bodies(size, periodic, step):
    dimension = len(size)
    identity = numpy.arange(BODIES)
    number = identity + 0.125 * step
    axes = numpy.arange(dimension)
    centers = number[:, None] * numpy.where(periodic, 0.3, 0.1) + 0.01 * axes
    velocity = number[:, None] + 100.0 * axes

    def turn(scale):
        components = numpy.stack([number * scale, number + scale, numpy.full(BODIES, scale)], axis=1)
        return components if dimension == 3 else numpy.pad(components[:, :1], ((0, 0), (2, 0)))

    rotation = numpy.tile(numpy.eye(3), (BODIES, 1, 1))
    block = numpy.add.outer(10.0 * axes, axes)
    rotation[:, :dimension, :dimension] = number[:, None, None] + block
    return {
        "center": in_space(numpy.where(periodic, centers % size, centers)),
        "radius": 0.1 + 0.01 * identity,
        "velocity": in_space(velocity),
        "spin": turn(2.0),
        "rotation": rotation.reshape(BODIES, 9),
        "force": in_space(-velocity),
        "torque": turn(-3.0),
        "contacts": identity % 4,
        "id": identity,
    }


def expected_fields(points, time):
    """Fields at points in the rows of an array, one column an axis."""
    dimension = points.shape[1]
    base = points @ (numpy.arange(dimension) + 1.0) + time
    velocity = base[:, None] + 10.0 * numpy.arange(dimension)
    return {
        "velocity": in_space(velocity),
        "pressure": base + 10.0 * dimension,
        "inside": (points[:, 0] < points[:, 1]).astype(float),
        "vorticity": base + 30.0 if dimension == 2 else base[:, None] + 10.0 * numpy.arange(4, 7),
    }


def check_hdf5(run, dimension, frames):
    same(run["times"], 0.25 * numpy.arange(frames), "times")
    same(run["steps"], numpy.arange(frames), "steps")
    assert sorted(run["frames"]) == [f"{number:06}" for number in range(frames)]
    for step in range(frames):
        frame = run[f"frames/{step:06}"]
        time, size, periodic = frame.attrs["time"], frame.attrs["size"], frame.attrs["periodic"].astype(bool)
        same([time, frame.attrs["step"]], [0.25 * step, step], "time and step")
        assert list(periodic) == [True, False, True][:dimension]
        for name, values in expected_bodies(size, periodic, step).items():
            same(frame["bodies"][name], values, f"{name} in frame {step}")
        cells, spacing = frame.attrs["cells"], frame.attrs["spacing"]
        same(cells * spacing, size, "cells fill the box")
        # slowest axis first: z, y, x
        grids = numpy.meshgrid(*[(numpy.arange(n) + 0.5) * h for n, h in zip(cells[::-1], spacing[::-1])], indexing="ij")
        points = numpy.stack([grid.ravel() for grid in grids[::-1]], axis=1)
        for name, values in expected_fields(points, time).items():
            stored = numpy.asarray(frame["fields"][name])
            assert stored.shape[:3] == (1,) * (3 - dimension) + tuple(cells[::-1])
            same(stored.reshape(values.shape), values, f"{name} in frame {step}")


def vtk_frames(path):
    """Times and data sets that VTK finds in a file of XDMF or VTKHDF."""
    reader = vtkHDFReader() if path.suffix == ".vtkhdf" else vtkXdmfReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    for time in times:
        reader.UpdateTimeStep(time)
        yield time, reader.GetOutputDataObject(0)


def arrays(data):
    return {data.GetArrayName(index): vtk_to_numpy(data.GetArray(index)) for index in range(data.GetNumberOfArrays())}


def cell_centers(image, dimension):
    return numpy.array([numpy.array(image.GetCell(cell).GetBounds()).reshape(3, 2).mean(axis=1) for cell in range(image.GetNumberOfCells())])[
        :, :dimension
    ]


def check_vtk(folder, size, periodic, frames):
    dimension = len(size)
    seen = list_of_times(folder / "bodies.xdmf", lambda step, data: check_points(data, expected_bodies(size, periodic, step)))
    same(seen, 0.25 * numpy.arange(frames), "times of bodies.xdmf")
    seen = list_of_times(folder / "fields.xdmf", lambda step, data: check_image(data, dimension, size, 0.25 * step))
    same(seen, 0.25 * numpy.arange(frames), "times of fields.xdmf")


def list_of_times(path, check):
    times = []
    for step, (time, data) in enumerate(vtk_frames(path)):
        times.append(time)
        check(step, data)
    return times


def check_points(data, expected):
    same(vtk_to_numpy(data.GetPoints().GetData()), expected["center"], "points")
    found = arrays(data.GetPointData())
    for name in expected.keys() - {"center"}:
        same(found[name], expected[name], f"{name} in VTK")


def check_image(data, dimension, size, time):
    same(numpy.array(data.GetBounds())[: 2 * dimension], numpy.stack([0 * size, size], axis=1).ravel(), "bounds")
    found = arrays(data.GetCellData())
    for name, values in expected_fields(cell_centers(data, dimension), time).items():
        same(found[name], values, f"{name} in VTK")


def check_run(folder):
    """Frames of a run in 2D agree with the laws of the scene and, at its end, with its summary."""
    # asked first: the run may end while its frames are read
    complete = (folder / "summary.json").exists()
    with h5py.File(folder / "run.h5") as run:
        times, names = numpy.asarray(run["times"]), sorted(run["frames"])
        assert len(times) == len(names) >= 2 and (numpy.diff(times) > 0).all(), f"times {times}"
        for name, time in zip(names, times):
            frame = run["frames"][name]
            same(frame.attrs["time"], time, "time")
            check_contacts(frame)
            if "fields" in frame:
                check_inside(frame)
            if "fields" in frame and "offset" not in frame.attrs:
                check_flow(frame)
        if complete:
            check_last(run["frames"][names[-1]], json.loads((folder / "summary.json").read_text()))
            frames = dict(zip(times, (run["frames"][name] for name in names)))
            check_network(folder, {time: frame["contacts"] for time, frame in frames.items()})
            check_vtkhdf(folder, frames)
            check_crate(folder)
            check_offsets(folder, frames)
            check_bonds(folder, frames)
            check_membranes(folder, frames)
            check_pairs(folder, frames)
        for companion in folder.glob("*.xdmf"):
            assert "<Time" in companion.read_text(), f"{companion} lists nothing"


def box(frame):
    """Lengths of a frame's box, which axes are periodic, and by how much the box above lies to the right."""
    periodic = in_space(numpy.array([frame.attrs["periodic"]]))[0].astype(bool)
    return in_space(numpy.array([frame.attrs["size"]]))[0], periodic, frame.attrs.get("offset", 0.0)


def nearest(frame, between):
    """The shortest of the periodic images of separations, by trying those of the rows around."""
    lengths, periodic, offset = box(frame)
    safe, best = numpy.where(periodic, lengths, 1.0), None
    for row in range(-2, 3) if periodic[1] else [0]:
        image = between - row * numpy.array([offset, lengths[1], 0.0])
        others = periodic & (numpy.arange(3) != 1)
        image = numpy.where(others, image - lengths * numpy.round(image / safe), image)
        shorter = None if best is None else (image**2).sum(-1, keepdims=True) < (best**2).sum(-1, keepdims=True)
        best = image if best is None else numpy.where(shorter, image, best)
    return best


def check_bonds(folder, frames):
    """Ends of bonds are the centres of their bodies, or images of them, bonds of a run are the same in all frames, and VTK sees them as lines."""
    assert (folder / "bonds.xdmf").exists() == all("bonds" in frame for frame in frames.values())
    if not (folder / "bonds.xdmf").exists():
        return
    first = next(iter(frames.values()))["bonds"]
    lines = {}
    for time, frame in frames.items():
        bonds, centers = frame["bonds"], numpy.asarray(frame["bodies/center"])
        body, point = numpy.asarray(bonds["body"]), numpy.asarray(bonds["point"])
        assert len(body) == 2 * frame.attrs["bond_count"] > 0 and (body.reshape(-1, 2)[:, 0] != body.reshape(-1, 2)[:, 1]).all()
        same(body, first["body"], "bonded bodies")
        same(bonds["chain"], first["chain"], "chains")
        same(nearest(frame, point - centers[body]), 0.0 * point, "ends of bonds")
        lengths = numpy.linalg.norm(point[1::2] - point[::2], axis=1)
        assert (lengths < 4.0 * numpy.asarray(frame["bodies/radius"]).max()).all(), f"bonds across the box at {time}"
        lines[time] = point
    for time, data in vtk_frames(folder / "bonds.xdmf"):
        assert data.GetNumberOfCells() == len(lines[time]) // 2
        same(vtk_to_numpy(data.GetPoints().GetData()), lines[time], "ends in VTK")
        cell = [data.GetCell(0).GetPointId(end) for end in (0, 1)]
        assert cell == [0, 1] and data.GetCell(data.GetNumberOfCells() - 1).GetPointId(1) == len(lines[time]) - 1
        same(arrays(data.GetPointData())["chain"], first["chain"], "chains in VTK")


def check_membranes(folder, frames):
    """Corners of membranes are the centres of their bodies, or images of them, polygons keep their areas, and VTK sees them."""
    assert (folder / "membranes.xdmf").exists() == all("membranes" in frame for frame in frames.values())
    if not (folder / "membranes.xdmf").exists():
        return
    first = next(iter(frames.values()))["membranes"]
    points, areas = {}, None
    for time, frame in frames.items():
        membranes, centers = frame["membranes"], numpy.asarray(frame["bodies/center"])
        points[time] = numpy.asarray(membranes["point"])
        same(membranes["body"], first["body"], "bodies of membranes")
        same(nearest(frame, points[time] - centers[numpy.asarray(membranes["body"])]), 0.0 * points[time], "corners of membranes")
    for time, data in vtk_frames(folder / "membranes.xdmf"):
        assert data.GetNumberOfCells() == frames[time].attrs["face_count"] > 0
        same(vtk_to_numpy(data.GetPoints().GetData()), points[time], "corners in VTK")
        corners = [[data.GetCell(face).GetPointId(corner) for corner in range(data.GetCell(face).GetNumberOfPoints())]
                   for face in range(data.GetNumberOfCells())]
        assert sorted(sum(corners, [])) == list(range(len(points[time]))), "corners of polygons"
        chain = arrays(data.GetPointData())["chain"]
        assert [set(chain[face]) for face in corners] == [{number} for number in range(len(corners))], "cells of polygons"
        x, y = zip(*[points[time][face, :2].T for face in corners])
        found = [((x * numpy.roll(y, -1) - y * numpy.roll(x, -1)).sum() / 2) for x, y in zip(x, y)]
        areas = areas or found
        assert max(abs(numpy.array(found) / areas - 1)) < 1e-9, f"areas {areas} became {found} at {time}"


def check_vtkhdf(folder, frames):
    """VTK's own reader finds every array of bodies and of fields that h5py finds in the frames, at the same times."""
    for kind, place in [("bodies", "center"), ("fields", None)]:
        path, expected = folder / f"{kind}.vtkhdf", {time: frame[kind] for time, frame in frames.items() if kind in frame}
        assert path.exists() == bool(expected), f"{path}: {len(expected)} frames with {kind}"
        times = []
        for time, data in vtk_frames(path) if expected else []:
            times.append(time)
            found, size = arrays(data.GetPointData() if place else data.GetCellData()), frames[time].attrs["size"]
            assert set(found) == set(expected[time]) - {place}, f"{sorted(found)} of {kind} in VTKHDF"
            if place:
                same(vtk_to_numpy(data.GetPoints().GetData()), expected[time][place], "points in VTKHDF")
                assert data.GetNumberOfVerts() == data.GetNumberOfPoints()
            else:
                same(data.GetBounds()[: 2 * len(size)], numpy.stack([0 * size, size], axis=1).ravel(), "bounds in VTKHDF")
            for name, values in found.items():
                same(values, numpy.asarray(expected[time][name]).reshape(values.shape), f"{name} of {kind} in VTKHDF")
        same(times, sorted(expected), f"times of {path}")


def check_crate(folder):
    """The RO-Crate describes every file of the run by its size and checksum, and each thing that it refers to."""
    graph = json.loads((folder / "ro-crate-metadata.json").read_text())["@graph"]
    things = {thing["@id"]: thing for thing in graph}
    root, run = things[things["ro-crate-metadata.json"]["about"]["@id"]], things["#run"]
    assert things["ro-crate-metadata.json"]["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"}
    assert len(things) == len(graph) and all(root[key] for key in ["name", "description", "datePublished", "license"])
    parts = {part["@id"] for part in root["hasPart"]}
    assert parts == {thing["@id"] for thing in graph if thing["@type"] == "File"}
    inputs, results = (run[key] if isinstance(run[key], list) else [run[key]] for key in ["object", "result"])
    assert parts == {entry["@id"] for entry in inputs + results} and {"@id": "scene.toml"} in inputs
    assert run["startTime"] <= run["endTime"] and things[run["instrument"]["@id"]]["@type"] == "SoftwareApplication"
    there = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert parts == there - {"ro-crate-metadata.json"}, f"{parts ^ there}"
    for part in parts:
        bytes = (folder / part).read_bytes()
        assert things[part]["contentSize"] == str(len(bytes)) and things[part]["sha256"] == hashlib.sha256(bytes).hexdigest(), part


def check_offsets(folder, frames):
    """Images slide at a steady rate, and VTK finds by how much."""
    sliding = {time: frame.attrs["offset"] for time, frame in frames.items() if "offset" in frame.attrs}
    for time, offset in sliding.items():
        rate, length = frames[time].attrs["offset_rate"], frames[time].attrs["size"][0]
        apart = (offset - rate * time) / length
        assert 0 <= offset < length and abs(apart - round(apart)) < 1e-9, f"offset {offset} at {time}"
    assert not sliding or (len(sliding) == len(frames) and len(set(sliding.values())) > 2), f"offsets {sliding}"
    for companion in ["bodies.xdmf", "fields.xdmf", "bodies.vtkhdf", "fields.vtkhdf"] if sliding else []:
        for time, data in vtk_frames(folder / companion):
            same(arrays(data.GetFieldData())["offset"], [sliding[time]], f"offset in {companion}")


def check_pairs(folder, frames):
    """The pair distribution of a periodic box is that of the frames it was measured in, image by image."""
    rows = numpy.genfromtxt(folder / "pairs.csv", delimiter=",", names=True)
    begin = json.loads((folder / "summary.json").read_text())["pairs"]["from_time"]
    chosen = [frame for time, frame in frames.items() if time >= begin]
    if not all(frame.attrs["periodic"].all() for frame in chosen):
        return
    count, diameter = len(chosen[0]["bodies/radius"]), 2 * chosen[0]["bodies/radius"][0]
    edges = numpy.append(rows["separation"] - 0.0125, rows["separation"][-1] + 0.0125)
    first, second = numpy.triu_indices(count, 1)
    found = numpy.zeros(len(rows))
    for frame in chosen:
        center = numpy.asarray(frame["bodies/center"])
        # beyond half a box a pair has more images than the nearest, which the distribution does not reach
        distance = numpy.linalg.norm(nearest(frame, center[second] - center[first]), axis=1) / diameter
        assert distance.min() > 1 - 1e-6, f"disks overlap: {distance.min()} diameters"
        found += numpy.histogram(numpy.maximum(distance, edges[0]), edges)[0]
    ideal = count * (count - 1) / 2 * numpy.pi * numpy.diff(edges**2) * diameter**2 / chosen[0].attrs["size"].prod()
    # a separation on the edge of two bins may be counted in either
    assert numpy.abs(found - rows["distribution"] * len(chosen) * ideal).sum() <= 2.01, "pairs are counted where they are not"


def check_contacts(frame):
    """Contacts are told by their bodies: normal, gap and image follow from the places of those."""
    contacts, bodies = frame["contacts"], frame["bodies"]
    count = frame.attrs["contact_count"]
    columns = {name: numpy.asarray(contacts[name]) for name in contacts}
    assert all(len(column) == count for column in columns.values()), "columns of contacts differ in length"
    center, radius, lengths = numpy.asarray(bodies["center"]), numpy.asarray(bodies["radius"]), box(frame)[0]
    for place in range(count):
        body, partner, normal = columns["body"][place], columns["partner"][place], columns["normal"][place]
        same(numpy.linalg.norm(normal), 1.0, "length of a normal")
        if partner >= 0:
            between = nearest(frame, center[partner] - center[body])
            gap = numpy.linalg.norm(between) - radius[body] - radius[partner]
            direction = between / numpy.linalg.norm(between)
        else:
            axis, upper = divmod(-1 - partner, 2)
            gap = (lengths[axis] - center[body][axis] if upper else center[body][axis]) - radius[body]
            direction = numpy.where(numpy.arange(3) == axis, 1.0 if upper else -1.0, 0.0)
        same(columns["gap"][place], gap, "gap of a contact")
        same(normal, direction, "normal of a contact")
        expected = center[body] + direction * (radius[body] + 0.5 * gap)
        apart = nearest(frame, columns["point"][place] - expected)
        same(apart, 0 * apart, "point")
    assert ("gamma" in columns) == ("gamma" in contacts)
    touches = numpy.zeros(len(radius), dtype=int)
    bearing = columns["force"] != 0
    numpy.add.at(touches, columns["body"][bearing], 1)
    numpy.add.at(touches, columns["partner"][bearing & (columns["partner"] >= 0)], 1)
    same(bodies["contacts"], touches, "contacts of bodies")
    if "gamma" in columns:
        assert (columns["gamma"] <= 0).all() and (numpy.abs(columns["gap"][columns["gamma"] < 0]) < 1e-3).all(), "memories of open gaps"


def check_network(folder, contacts):
    """VTK finds in contacts.xdmf what the frames hold; those without contacts are not listed."""
    listed, some = 0, any(len(frame["gap"]) > 0 for frame in contacts.values())
    # VTK complains of a list of nothing
    for time, data in vtk_frames(folder / "contacts.xdmf") if some else []:
        expected = contacts[time]
        same(vtk_to_numpy(data.GetPoints().GetData()), expected["point"], "points of contacts in VTK")
        found = arrays(data.GetPointData())
        for name in set(expected) - {"point", "image"}:
            same(found[name], expected[name], f"{name} of contacts in VTK")
        listed += 1
    assert listed == sum(len(frame["gap"]) > 0 for frame in contacts.values()), f"{listed} frames with contacts are listed"


def check_inside(frame):
    """Cells are inside bodies where the nearest images of those are."""
    inside, (cells, spacing) = numpy.asarray(frame["fields/inside"])[0], (frame.attrs[name] for name in ["cells", "spacing"])
    x, y = numpy.meshgrid(*[(numpy.arange(n) + 0.5) * h for n, h in zip(cells, spacing)])
    points = numpy.stack([x, y, 0 * x], axis=-1)
    depth = numpy.full(inside.shape, -numpy.inf)
    for center, radius in zip(numpy.asarray(frame["bodies/center"]), numpy.asarray(frame["bodies/radius"])):
        depth = numpy.maximum(depth, radius - numpy.linalg.norm(nearest(frame, points - center), axis=-1))
    clear = numpy.abs(depth) > 1e-9
    assert ((depth > 0) == (inside == 1))[clear].all(), "cells are inside bodies that are elsewhere"


def check_flow(frame):
    velocity, inside = numpy.asarray(frame["fields/velocity"])[0], numpy.asarray(frame["fields/inside"])[0]
    filled, area = inside.mean() * frame.attrs["size"].prod(), (numpy.pi * numpy.asarray(frame["bodies/radius"]) ** 2).sum()
    assert abs(filled / area - 1) < 0.05, f"bodies of area {area} fill {filled}"
    for speed, cells in [(-3.0, slice(0, 4)), (3.0, slice(-1, -5, -1))]:
        # where a body is near, the velocity bends within a cell
        clear = (inside[cells] == 0).all(axis=0)
        if clear.any():
            # through the centres of cells, half a cell, one and a half and two and a half from the wall
            first, second, third = velocity[cells][:3]
            at_wall = numpy.median((1.875 * first - 1.25 * second + 0.375 * third)[clear, :2], axis=0)
            assert abs(at_wall - [speed, 0.0]).max() < 0.3, f"at a wall that moves at {speed} the fluid moves at {at_wall}"


def check_last(frame, summary):
    same(frame.attrs["time"], summary["time"], "time of the last frame")
    bodies = frame["bodies"]
    in_summary = {name: in_space(numpy.array([body[name] for body in summary["bodies"]])) for name in ["center", "velocity", "force"]}
    same(bodies["center"], in_summary["center"], "center")
    same(bodies["force"], in_summary["force"], "force")
    # flow and contacts agree on velocities to this; a frame has those by the contacts, the summary those by the flow
    assert numpy.abs(numpy.asarray(bodies["velocity"]) - in_summary["velocity"]).max() < 1e-5 * 3.0, "velocity"
    same(bodies["radius"], [body["radius"] for body in summary["bodies"]], "radius")
    touches, active = int(numpy.asarray(bodies["contacts"]).sum()), summary["contact"]["active"]
    # a wall has no number of its own
    assert active <= touches <= 2 * active, f"{active} contacts, and bodies that touch {touches} times"


def main():
    if sys.argv[2] == "run":
        check_run(pathlib.Path(sys.argv[1]))
        return
    folder, dimension, frames = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    with h5py.File(folder / "run.h5") as run:
        check_hdf5(run, dimension, frames)
        first = run["frames/000000"]
        check_vtk(folder, first.attrs["size"], first.attrs["periodic"].astype(bool), frames)
        # the writer goes on while this file is open; what it lists stays readable
        print("checked", flush=True)
        sys.stdin.readline()
        check_hdf5(run, dimension, frames)
    print("checked again", flush=True)


main()
