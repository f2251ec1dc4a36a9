//! VTKHDF 2: frames for the reader of HDF5 that VTK and ParaView have of their own, one file a kind: bodies as points, fields on the cells.
//!
//! The format wants an array of all times in one data set. These are virtual data sets, which HDF5 puts together from the frames while they are read: nothing is
//! stored twice, and a file is of use beside the folder of the frames only. A virtual data set cannot grow, so that a file is written as a whole: when a run
//! begins or goes on, and when it ends.
//! Source: <https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html>

use std::{fs, io, iter, path::Path};

use hdf5::{Group, Hyperslab, SliceOrIndex, types::FixedAscii};

use super::{
    body,
    entry::{Entry, path_in_run},
    listing::Format,
    store::{OFFSET, field_columns},
};
use crate::output::files::{
    parallel_file::{cause, reserve},
    slab,
};

/// Version of the format.
const VERSION: [i64; 2] = [2, 2];

/// Room that a file takes, and each frame in it, in bytes; both need less than half of it.
const ROOM: u64 = 1 << 17;
const ROOM_OF_ENTRY: u64 = 1 << 12;

/// Kinds of cells of a `PolyData`; bodies are of the first one.
const CELLS: [&str; 4] = ["Vertices", "Lines", "Polygons", "Strips"];

/// A file that shows one kind of thing at all times.
pub(super) struct Series {
    /// Name of the file.
    pub name: &'static str,
    /// Whether a frame has any of it.
    shown: fn(&Entry) -> bool,
    /// Writes what it shows of these frames, at least one.
    write: fn(&Group, &[&Entry]) -> hdf5::Result<()>,
}

/// The bodies as points that move, and the fields on the cells.
pub(super) const SERIES: [Series; 2] = [
    Series { name: "bodies.vtkhdf", shown: |entry| entry.bodies > 0, write: cloud },
    Series { name: "fields.vtkhdf", shown: |entry| entry.mesh.is_some(), write: lattice },
];

impl Format for Series {
    fn empty(&self) -> bool {
        false
    }

    fn lists(&self, entry: &Entry) -> bool {
        (self.shown)(entry)
    }

    fn create(&self, path: &Path, entries: &[&Entry]) -> io::Result<()> {
        reserve(&fs::File::create(path)?, 0, ROOM + ROOM_OF_ENTRY * entries.len() as u64)?;
        self.create_file(path, entries).map_err(|error| cause(&error))
    }
}

impl Series {
    fn create_file(&self, path: &Path, entries: &[&Entry]) -> hdf5::Result<()> {
        let file = hdf5::File::with_options().with_fapl(|access| access.libver_v110()).create(path)?;
        (self.write)(&file.create_group("VTKHDF")?, entries)?;
        file.close()
    }
}

/// Frames one behind the other along the first axis of data sets.
struct Sequence<'e> {
    entries: &'e [&'e Entry],
    /// Where each begins.
    starts: Vec<usize>,
    /// Where the last one ends.
    end: usize,
}

impl<'e> Sequence<'e> {
    /// Of frames that take so many places each.
    fn new(entries: &'e [&'e Entry], length: impl Fn(&Entry) -> usize) -> Sequence<'e> {
        let (mut starts, mut end) = (Vec::with_capacity(entries.len()), 0);
        for entry in entries {
            starts.push(end);
            end += length(entry);
        }
        Sequence { entries, starts, end }
    }

    /// A data set of what all frames hold at a path, without a copy; `inner` are the extents of a place, `of_frame` those of a frame's own data set.
    fn join(&self, group: &Group, source: &Source, inner: &[usize], of_frame: impl Fn(usize) -> Vec<usize>) -> hdf5::Result<()> {
        let builder = if source.real { group.new_dataset::<f64>() } else { group.new_dataset::<i32>() };
        let extents: Vec<usize> = [&[self.end], inner].concat();
        let mut builder = builder.shape(extents.clone());
        let ends = self.starts.iter().skip(1).copied().chain([self.end]);
        for ((entry, &start), end) in self.entries.iter().zip(&self.starts).zip(ends) {
            let ranges = iter::once(start..end).chain(inner.iter().map(|&extent| 0..extent));
            let place = Hyperslab::from(ranges.map(SliceOrIndex::from).collect::<Vec<_>>());
            builder = builder.virtual_map(path_in_run(entry.number), &source.path, of_frame(end - start), .., extents.clone(), place);
        }
        builder.create(source.name).map(drop)
    }

    /// The group of what differs from time to time, with the times.
    fn steps(&self, root: &Group) -> hdf5::Result<Group> {
        let steps = root.create_group("Steps")?;
        slab::set(&steps, "NSteps", self.entries.len() as i64)?;
        let times: Vec<f64> = self.entries.iter().map(|entry| entry.time).collect();
        steps.new_dataset::<f64>().shape(times.len()).create("Values")?.write_raw(&times)?;
        self.images(root, &steps)?;
        Ok(steps)
    }

    /// By how much the images above the box lie to the right, where they slide.
    fn images(&self, root: &Group, steps: &Group) -> hdf5::Result<()> {
        let Some(offsets) = self.entries.iter().map(|entry| entry.offset).collect::<Option<Vec<f64>>>() else { return Ok(()) };
        let count = offsets.len();
        root.create_group("FieldData")?.new_dataset::<f64>().shape(count).create(OFFSET)?.write_raw(&offsets)?;
        whole(&steps.create_group("FieldDataOffsets")?, OFFSET, &[count], 0..count)?;
        whole(&steps.create_group("FieldDataSizes")?, OFFSET, &[count, 2], iter::repeat_n(1, 2 * count))
    }

    /// Where each frame begins in data sets that [`join`](Sequence::join) makes.
    fn begins(&self, group: &Group, name: &str) -> hdf5::Result<()> {
        whole(group, name, &[self.starts.len()], self.starts.iter().copied())
    }
}

/// A data set that frames hold.
struct Source {
    /// Name of the data set that is made of it.
    name: &'static str,
    /// Path in a frame.
    path: String,
    /// Whether its numbers are real, not whole.
    real: bool,
}

fn cloud(root: &Group, entries: &[&Entry]) -> hdf5::Result<()> {
    describe(root, FixedAscii::<8>::from_ascii("PolyData"))?;
    let sequence = Sequence::new(entries, |entry| entry.bodies);
    let steps = sequence.steps(root)?;
    store_parts(root, &steps, entries)?;
    let join = |group: &Group, name: &'static str, column: &str, width: usize, real: bool| {
        let (path, inner) = (format!("bodies/{column}"), if width == 1 { vec![] } else { vec![width] });
        sequence.join(group, &Source { name, path, real }, &inner, |bodies| [&[bodies], &inner[..]].concat())
    };
    join(root, "Points", "center", 3, true)?;
    sequence.begins(&steps, "PointOffsets")?;
    let (data, offsets) = (root.create_group("PointData")?, steps.create_group("PointDataOffsets")?);
    for (name, width, real) in body::at_centers() {
        join(&data, name, name, width, real)?;
        sequence.begins(&offsets, name)?;
    }
    Ok(())
}

/// The points as cells: one list for frames that follow each other with the same number of bodies.
fn store_parts(root: &Group, steps: &Group, entries: &[&Entry]) -> hdf5::Result<()> {
    let parts: Vec<usize> = entries.chunk_by(|one, next| one.bodies == next.bodies).map(|same| same[0].bodies).collect();
    whole(root, "NumberOfPoints", &[parts.len()], parts.iter().copied())?;
    for kind in CELLS {
        let group = root.create_group(kind)?;
        let counts: Vec<usize> = parts.iter().map(|&bodies| if kind == CELLS[0] { bodies } else { 0 }).collect();
        let (total, corners) = (counts.iter().sum(), || counts.iter().flat_map(|&count| 0..count));
        whole(&group, "NumberOfCells", &[parts.len()], counts.iter().copied())?;
        whole(&group, "NumberOfConnectivityIds", &[parts.len()], counts.iter().copied())?;
        whole(&group, "Connectivity", &[total], corners())?;
        whole(&group, "Offsets", &[total + parts.len()], counts.iter().flat_map(|&count| 0..=count))?;
    }
    let (mut part, mut first, mut places) = (0, 0, Vec::new());
    for (number, entry) in entries.iter().enumerate() {
        if number > 0 && entry.bodies != entries[number - 1].bodies {
            (part, first) = (part + 1, first + entries[number - 1].bodies);
        }
        places.push((part, first));
    }
    let count = places.len();
    whole(steps, "PartOffsets", &[count], places.iter().map(|(part, _)| *part))?;
    whole(steps, "NumberOfParts", &[count], iter::repeat_n(1, count))?;
    let firsts = || places.iter().flat_map(|&(_, first)| [first, 0, 0, 0]);
    whole(steps, "CellOffsets", &[count, CELLS.len()], firsts())?;
    whole(steps, "ConnectivityIdOffsets", &[count, CELLS.len()], firsts())
}

/// The grid, which is the same in all frames of a run. A single frame is no series: VTK (9.3 to 9.7) takes the first axis of arrays for z then.
fn lattice(root: &Group, entries: &[&Entry]) -> hdf5::Result<()> {
    let Some(mesh) = &entries[0].mesh else { return Ok(()) };
    describe(root, FixedAscii::<9>::from_ascii("ImageData"))?;
    let (cells, mut origin, mut spacing) = mesh.in_space();
    let [z, y, x] = cells.map(|cells| cells as i64);
    origin.reverse();
    spacing.reverse();
    slab::set_all(root, "WholeExtent", &[0, x, 0, y, 0, z])?;
    slab::set_all(root, "Origin", &origin)?;
    slab::set_all(root, "Spacing", &spacing)?;
    slab::set_all(root, "Direction", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])?;
    let single = entries.len() == 1;
    let sequence = Sequence::new(entries, |_| if single { cells[0] } else { 1 });
    let data = root.create_group("CellData")?;
    let offsets = if single { None } else { Some(sequence.steps(root)?.create_group("CellDataOffsets")?) };
    let vorticity = entries.iter().all(|entry| entry.mesh.as_ref().is_some_and(|mesh| mesh.vorticity));
    for (name, width) in field_columns(mesh.cells.len(), vorticity) {
        let frame: Vec<usize> = cells.into_iter().chain((width > 1).then_some(width)).collect();
        let source = Source { name, path: format!("fields/{name}"), real: true };
        sequence.join(&data, &source, &frame[usize::from(single)..], |_| frame.clone())?;
        offsets.as_ref().map_or(Ok(()), |offsets| sequence.begins(offsets, name))?;
    }
    Ok(())
}

/// Says what a file holds; the text has the length of its type, as VTK wants it.
fn describe<const N: usize>(root: &Group, kind: Result<FixedAscii<N>, hdf5::types::StringError>) -> hdf5::Result<()> {
    slab::set_all(root, "Version", &VERSION)?;
    slab::set(root, "Type", kind.map_err(|error| error.to_string())?)
}

/// A data set of whole numbers.
fn whole(group: &Group, name: &str, shape: &[usize], numbers: impl IntoIterator<Item = usize>) -> hdf5::Result<()> {
    let numbers: Vec<i64> = numbers.into_iter().map(|number| number as i64).collect();
    let dataset = group.new_dataset::<i64>().shape(shape).create(name)?;
    if numbers.is_empty() { Ok(()) } else { dataset.write_raw(&numbers) }
}
