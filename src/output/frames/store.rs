//! The contents of a frame's file.
//!
//! Bodies stand in columns. Fields have the shape `z, y, x[, component]`, slowest first as XDMF wants it, over all cells of
//! the box, whichever rank owned them; 2D is one layer of cells.

use hdf5::{Dataset, Group};

use super::{
    Frame, FrameContact, FrameFields,
    body::{COLUMNS, COUNTS, in_space},
    contact,
};
use crate::{
    error::Result,
    grid::{Block, Grid},
    observe::FrameBody,
    output::{parallel_file::ParallelFile, slab},
};

/// Name of the file format.
pub(super) const FORMAT: &str = "turbid frame";
/// Version of the file format.
pub(super) const VERSION: u32 = 1;
/// Displacement along x of the images above the box, where images slide; `offset_rate` is its rate of change.
pub(super) const OFFSET: &str = "offset";
/// Named numbers and vectors of each cell.
pub(super) const FIELDS: [(&str, usize); 3] = [("velocity", 3), ("pressure", 1), ("inside", 1)];

/// Writes a frame.
pub(super) fn store<const D: usize>(file: &mut ParallelFile, frame: &Frame<D>) -> Result<()> {
    make_room(file, frame)?;
    file.step(|root| describe(root, frame))?;
    store_bodies(file, frame)?;
    store_contacts(file, frame)?;
    frame.fields.as_ref().map_or(Ok(()), |fields| store_fields(file, fields))
}

fn make_room<const D: usize>(file: &mut ParallelFile, frame: &Frame<D>) -> Result<()> {
    let cells = frame.fields.as_ref().map_or(0, |fields| fields.grid.unknowns(D));
    let columns = COLUMNS.iter().map(|(_, width)| frame.bodies.len() * width * size_of::<f64>());
    let counts = COUNTS.iter().map(|_| frame.bodies.len() * size_of::<i32>());
    let fields = FIELDS.iter().map(|(_, width)| cells * width * size_of::<f64>());
    let contact = contact::COLUMNS.iter().chain(&[(contact::GAMMA, 1)]).map(|(_, width)| width * size_of::<f64>()).sum::<usize>()
        + contact::COUNTS.iter().map(|(_, width)| width * size_of::<i32>()).sum::<usize>();
    let contacts = frame.contacts.map_or(0, <[_]>::len) * contact;
    file.make_room(columns.chain(counts).chain(fields).sum::<usize>() + contacts)
}

fn describe<const D: usize>(root: &Group, frame: &Frame<D>) -> hdf5::Result<()> {
    slab::set_text(root, "format", FORMAT)?;
    slab::set(root, "version", VERSION)?;
    slab::set_text(root, "units", "those of the scene; none are converted")?;
    slab::set(root, "time", frame.time)?;
    slab::set(root, "step", frame.step as u64)?;
    slab::set(root, "body_count", frame.bodies.len() as u64)?;
    slab::set_all(root, "size", frame.domain.size.as_slice())?;
    slab::set_all(root, "periodic", &std::array::from_fn::<u8, D, _>(|axis| u8::from(frame.domain.periodic(axis))))?;
    if let (Some(offset), Some(slide)) = (frame.offset(), frame.domain.slide()) {
        slab::set(root, OFFSET, offset)?;
        slab::set(root, "offset_rate", slide.speed)?;
    }
    if let Some(contacts) = frame.contacts {
        slab::set(root, "contact_count", contacts.len() as u64)?;
    }
    if let Some(fields) = &frame.fields {
        slab::set_all(root, "cells", &fields.grid.cells().map(|cells| cells as u64))?;
        slab::set_all(root, "spacing", fields.grid.spacing().as_slice())?;
    }
    Ok(())
}

/// A column of a group: its name, the numbers of each entry, and the numbers of all entries.
type Column<T> = (&'static str, usize, Vec<T>);

fn store_bodies<const D: usize>(file: &ParallelFile, frame: &Frame<D>) -> Result<()> {
    let in_box = frame.bodies.iter().map(|body| {
        let velocity = body.velocity - frame.domain.image_velocity(&body.center);
        FrameBody { center: frame.domain.wrap(body.center), velocity, ..body.clone() }.columns()
    });
    let contacts = frame.bodies.iter().map(|body| body.contacts as i32).collect();
    let counts = COUNTS.into_iter().zip([(0..frame.bodies.len() as i32).collect(), contacts]).map(|(name, values)| (name, 1, values));
    store_group(file, "bodies", frame.bodies.len(), &columns(&COLUMNS, in_box), &counts.collect::<Vec<_>>())
}

fn store_contacts<const D: usize>(file: &ParallelFile, frame: &Frame<D>) -> Result<()> {
    let Some(contacts) = frame.contacts else { return Ok(()) };
    let in_box = contacts.iter().map(|contact| FrameContact { point: frame.domain.wrap(contact.point), ..*contact }.columns());
    let mut numbers = columns(&contact::COLUMNS, in_box);
    let gamma: Vec<f64> = contacts.iter().filter_map(|contact| contact.gamma).collect();
    numbers.extend((!gamma.is_empty()).then_some((contact::GAMMA, 1, gamma)));
    let counts = columns(&contact::COUNTS, contacts.iter().map(FrameContact::counts));
    store_group(file, "contacts", contacts.len(), &numbers, &counts)
}

/// The columns of entries that give their numbers column by column.
fn columns<T, const C: usize>(names: &[(&'static str, usize); C], entries: impl Iterator<Item = [Vec<T>; C]>) -> Vec<Column<T>> {
    let mut columns: Vec<Column<T>> = names.iter().map(|&(name, width)| (name, width, Vec::new())).collect();
    entries.for_each(|entry| columns.iter_mut().zip(entry).for_each(|((.., values), numbers)| values.extend(numbers)));
    columns
}

/// Stores a group of columns, which the first rank writes.
fn store_group(file: &ParallelFile, name: &str, count: usize, numbers: &[Column<f64>], counts: &[Column<i32>]) -> Result<()> {
    fn make<T: hdf5::H5Type>(group: &Group, count: usize, columns: &[Column<T>]) -> hdf5::Result<Vec<Dataset>> {
        let shape = |width: usize| if width == 1 { vec![count] } else { vec![count, width] };
        columns.iter().map(|&(name, width, _)| group.new_dataset::<T>().shape(shape(width)).create(name)).collect()
    }
    fn write<T: hdf5::H5Type>(datasets: &[Dataset], columns: &[Column<T>]) -> hdf5::Result<()> {
        datasets.iter().zip(columns).try_for_each(|(dataset, (.., values))| dataset.write_raw(values))
    }
    let (of_numbers, of_counts) = file.step(|root| {
        let group = root.create_group(name)?;
        Ok((make(&group, count, numbers)?, make(&group, count, counts)?))
    })?;
    if count == 0 {
        return Ok(());
    }
    let first = file.world().rank() == 0;
    file.step(|_| if first { write(&of_numbers, numbers).and_then(|()| write(&of_counts, counts)) } else { Ok(()) })
}

fn store_fields<const D: usize>(file: &ParallelFile, fields: &FrameFields<D>) -> Result<()> {
    let grid = fields.grid;
    let datasets = file.step(|root| {
        let group = root.create_group("fields")?;
        let shape = |width: usize| {
            let layer = (D == 2).then_some(1);
            layer.into_iter().chain(grid.cells().into_iter().rev()).chain((width > 1).then_some(width)).collect::<Vec<_>>()
        };
        let datasets = FIELDS.iter().map(|&(name, width)| group.new_dataset::<f64>().shape(shape(width)).create(name));
        datasets.collect::<hdf5::Result<Vec<Dataset>>>()
    })?;
    let velocity: Vec<f64> = fields.velocity.iter().flat_map(in_space).collect();
    file.step(|_| {
        let values = [&velocity, &fields.pressure, &fields.inside];
        let mut all = datasets.iter().zip(FIELDS).zip(values);
        all.try_for_each(|((dataset, (_, width)), values)| write_field(dataset, grid, width, values))
    })
}

fn write_field<const D: usize>(dataset: &Dataset, grid: &Grid<D>, width: usize, values: &[f64]) -> hdf5::Result<()> {
    let block = grid.block(D);
    let mut ranges = slab::ranges(block, grid.lattice(D));
    ranges.extend((D == 2).then_some(0..1));
    ranges.reverse();
    ranges.extend((width > 1).then_some(0..width));
    slab::write(dataset, &ranges, &first_axis_fastest(block, width, values))
}

/// The values of a block, `width` an index, in the order in which the first axis runs fastest.
fn first_axis_fastest<const D: usize>(block: Block<D>, width: usize, values: &[f64]) -> Vec<f64> {
    let mut turned = vec![0.0; values.len()];
    for (index, entries) in block.indices().zip(values.chunks(width)) {
        let place = (0..D).rev().fold(0, |place, axis| place * (block.end[axis] - block.start[axis]) + index[axis] - block.start[axis]);
        turned[place * width..][..width].copy_from_slice(entries);
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_axis_runs_fastest() {
        let block = Block { start: [1, 0, 2], end: [3, 3, 6] };
        let values: Vec<f64> = block.indices().flat_map(|[x, y, z]| [(x + 10 * y + 100 * z) as f64, -1.0]).collect();
        let turned = first_axis_fastest(block, 2, &values);
        let mut expected = Vec::new();
        for z in 2..6 {
            for y in 0..3 {
                for x in 1..3 {
                    expected.extend([f64::from(x + 10 * y + 100 * z), -1.0]);
                }
            }
        }
        assert_eq!(turned, expected);
    }
}
