//! The contents of a frame's file.
//!
//! Bodies stand in columns, in the order of their numbers, whichever rank had them. Fields have the shape `z, y, x[, component]`, slowest first as XDMF wants it, over all cells of
//! the box, whichever rank owned them; 2D is one layer of cells.

use std::{iter, ops::Range};

use hdf5::{Dataset, Group};

use super::{
    Frame, FrameFields,
    body::{self, in_space},
    bond, contact,
    frame::FrameRows,
    membrane,
};
use crate::{
    error::Result,
    grid::{Block, Grid},
    output::files::{
        checksum::{CHECKSUM, checksum, numbers_checksum, sums_of_all},
        parallel_file::ParallelFile,
        rows::Rows,
        slab,
    },
};

/// Name of the file format.
pub(super) const FORMAT: &str = "turbid frame";
/// Version of the file format.
pub(super) const VERSION: u32 = 1;
/// Displacement along x of the images above the box, where images slide; `offset_rate` is its rate of change.
pub(super) const OFFSET: &str = "offset";
/// The vorticity of each cell, where frames hold it.
pub(super) const VORTICITY: &str = "vorticity";

/// Named numbers and vectors of each cell in a dimension.
pub(super) fn field_columns(dimension: usize, vorticity: bool) -> Vec<(&'static str, usize)> {
    let of_flow = [("velocity", 3), ("pressure", 1), ("inside", 1)];
    of_flow.into_iter().chain(vorticity.then_some((VORTICITY, dimension * (dimension - 1) / 2))).collect()
}

/// Writes a frame with these rows.
pub(super) fn store<const D: usize>(file: &mut ParallelFile, frame: &Frame<D>, rows: &FrameRows) -> Result<()> {
    make_room(file, frame, rows)?;
    file.step(|root| describe(root, frame, rows))?;
    store_group(file, "bodies", &rows.bodies, &body_columns())?;
    if let Some((contacts, present)) = &rows.contacts {
        store_group(file, "contacts", contacts, &contact_columns(*present))?;
    }
    if let Some(ends) = &rows.bonds {
        store_group(file, "bonds", ends, &bond_columns())?;
    }
    if let Some(membranes) = &rows.membranes {
        store_group(file, "membranes", &membranes.corners, &membrane_columns())?;
        store_group(file, "faces", &membranes.topology, &columns(&[(membrane::TOPOLOGY, 1)], 1, true))?;
    }
    frame.fields.as_ref().map_or(Ok(()), |fields| store_fields(file, fields))
}

fn make_room<const D: usize>(file: &mut ParallelFile, frame: &Frame<D>, rows: &FrameRows) -> Result<()> {
    let fields = frame.fields.as_ref().map_or(0, |fields| {
        let columns = field_columns(D, fields.vorticity.is_some());
        columns.iter().map(|(_, width)| fields.grid.unknowns(D) * width * size_of::<f64>()).sum::<usize>()
    });
    let bodies = rows.bodies.total() * body::WIDTH * size_of::<f64>();
    let contacts = rows.contacts.as_ref().map_or(0, |(contacts, _)| contacts.total() * contact::WIDTH * size_of::<f64>());
    let bonds = rows.bonds.as_ref().map_or(0, |ends| ends.total() * (bond::WIDTH + 1) * size_of::<f64>());
    let membranes = rows
        .membranes
        .as_ref()
        .map_or(0, |membranes| (membranes.corners.total() * membrane::WIDTH + membranes.topology.total()) * size_of::<f64>());
    file.make_room(bodies + contacts + bonds + membranes + fields)
}

fn describe<const D: usize>(root: &Group, frame: &Frame<D>, rows: &FrameRows) -> hdf5::Result<()> {
    slab::set_text(root, "format", FORMAT)?;
    slab::set(root, "version", VERSION)?;
    slab::set_text(root, "units", "those of the scene; none are converted")?;
    slab::set(root, "time", frame.time)?;
    slab::set(root, "step", frame.step as u64)?;
    slab::set(root, "body_count", rows.bodies.total() as u64)?;
    slab::set_all(root, "size", frame.domain.size.as_slice())?;
    slab::set_all(root, "periodic", &std::array::from_fn::<u8, D, _>(|axis| u8::from(frame.domain.periodic(axis))))?;
    if let (Some(offset), Some(slide)) = (frame.offset(), frame.domain.slide()) {
        slab::set(root, OFFSET, offset)?;
        slab::set(root, "offset_rate", slide.speed())?;
    }
    if let Some((contacts, _)) = &rows.contacts {
        slab::set(root, "contact_count", contacts.total() as u64)?;
    }
    if let Some(ends) = &rows.bonds {
        slab::set(root, "bond_count", (ends.total() / 2) as u64)?;
    }
    if let Some(membranes) = &rows.membranes {
        slab::set(root, "face_count", membranes.faces as u64)?;
    }
    if let Some(fields) = &frame.fields {
        slab::set_all(root, "cells", &fields.grid.cells().map(|cells| cells as u64))?;
        slab::set_all(root, "spacing", fields.grid.spacing().as_slice())?;
    }
    Ok(())
}

/// A column of a group.
struct DatasetColumn {
    name: &'static str,
    /// Where its numbers are in a row; empty for the place of the row itself among all.
    place: Range<usize>,
    /// Whether they are whole.
    whole: bool,
}

fn column(name: &'static str, place: usize, width: usize, whole: bool) -> DatasetColumn {
    DatasetColumn { name, place: place..place + width, whole }
}

/// Columns of a row from a place on, one after the other.
fn columns(names: &[(&'static str, usize)], start: usize, whole: bool) -> Vec<DatasetColumn> {
    let place = |place: &mut usize, &(name, width): &(&'static str, usize)| {
        Some(column(name, std::mem::replace(place, *place + width), width, whole))
    };
    names.iter().scan(start, place).collect()
}

fn body_columns() -> Vec<DatasetColumn> {
    let counts = body::COUNTS.into_iter().zip([0, body::WIDTH - 1]).map(|(name, place)| column(name, place, 1, true));
    columns(&body::COLUMNS, 1, false).into_iter().chain(counts).collect()
}

fn contact_columns(present: contact::Present) -> Vec<DatasetColumn> {
    let counts = columns(&contact::COUNTS, 0, true);
    let start = counts.last().map_or(0, |count| count.place.end);
    let always = columns(&contact::COLUMNS, start, false);
    let start = always.last().map_or(0, |column| column.place.end);
    let optional = columns(&contact::OPTIONAL, start, false).into_iter().zip(present).filter(|(_, present)| *present);
    always.into_iter().chain(optional.map(|(column, _)| column)).chain(counts).collect()
}

fn bond_columns() -> Vec<DatasetColumn> {
    let counts = columns(&bond::COUNTS, 1, true);
    let start = counts.last().map_or(0, |count| count.place.end);
    let number = column(bond::NODE, 0, 0, true);
    columns(&bond::COLUMNS, start, false).into_iter().chain(counts).chain([number]).collect()
}

fn membrane_columns() -> Vec<DatasetColumn> {
    let counts = columns(&membrane::COUNTS, 0, true);
    let start = counts.last().map_or(0, |count| count.place.end);
    counts.into_iter().chain(columns(&membrane::COLUMNS, start, false)).collect()
}

/// Stores a group of columns, of which each rank writes its rows.
fn store_group(file: &ParallelFile, name: &str, rows: &Rows, columns: &[DatasetColumn]) -> Result<()> {
    let create = |group: &Group, column: &DatasetColumn, sum: u64| {
        let width = column.place.len();
        let shape = if width <= 1 { vec![rows.total()] } else { vec![rows.total(), width] };
        let dataset = match column.whole {
            true => group.new_dataset::<i32>().shape(shape).create(column.name),
            false => group.new_dataset::<f64>().shape(shape).create(column.name),
        }?;
        slab::set(&dataset, CHECKSUM, sum)?;
        Ok(dataset)
    };
    let sums = sums_of_all(file.world(), &columns.iter().map(|column| column_checksum(rows, column)).collect::<Vec<_>>());
    let datasets = file.step(|root| {
        let group = root.create_group(name)?;
        columns.iter().zip(&sums).map(|(column, &sum)| create(&group, column, sum)).collect::<hdf5::Result<Vec<Dataset>>>()
    })?;
    if rows.places().is_empty() {
        return file.step(|_| Ok(()));
    }
    file.step(|_| datasets.iter().zip(columns).try_for_each(|(dataset, column)| write_column(dataset, rows, column)))
}

/// The checksum of this rank's rows of a column.
fn column_checksum(rows: &Rows, column: &DatasetColumn) -> u64 {
    let (start, width) = (rows.places().start, column.place.len());
    let numbered = || rows.places().map(|place| place as f64).collect::<Vec<_>>();
    let values = if width == 0 { numbered() } else { rows.columns(column.place.clone(), |number| number) };
    numbers_checksum(start * width.max(1), &values)
}

fn write_column(dataset: &Dataset, rows: &Rows, column: &DatasetColumn) -> hdf5::Result<()> {
    let width = column.place.len();
    let ranges: Vec<Range<usize>> = iter::once(rows.places()).chain((width > 1).then_some(0..width)).collect();
    match column.whole {
        true if width == 0 => slab::write(dataset, &ranges, &rows.places().map(|place| place as i32).collect::<Vec<_>>()),
        true => slab::write(dataset, &ranges, &rows.columns(column.place.clone(), |number| number as i32)),
        false => slab::write(dataset, &ranges, &rows.columns(column.place.clone(), |number| number)),
    }
}

fn store_fields<const D: usize>(file: &ParallelFile, fields: &FrameFields<D>) -> Result<()> {
    let (grid, columns) = (fields.grid, field_columns(D, fields.vorticity.is_some()));
    let velocity: Vec<f64> = fields.velocity.iter().flat_map(in_space).collect();
    let values = [&velocity, &fields.pressure, &fields.inside].into_iter().chain(&fields.vorticity);
    let turned: Vec<Vec<f64>> =
        values.zip(&columns).map(|(values, (_, width))| first_axis_fastest(grid.block(D), *width, values)).collect();
    let sums: Vec<u64> = turned.iter().zip(&columns).map(|(values, (_, width))| field_checksum(grid, *width, values)).collect();
    let sums = sums_of_all(file.world(), &sums);
    let datasets = file.step(|root| {
        let group = root.create_group("fields")?;
        let shape = |width: usize| {
            let layer = (D == 2).then_some(1);
            layer.into_iter().chain(grid.cells().into_iter().rev()).chain((width > 1).then_some(width)).collect::<Vec<_>>()
        };
        let create = |(&(name, width), &sum): (&(&str, usize), &u64)| {
            let dataset = group.new_dataset::<f64>().shape(shape(width)).create(name)?;
            slab::set(&dataset, CHECKSUM, sum)?;
            Ok(dataset)
        };
        columns.iter().zip(&sums).map(create).collect::<hdf5::Result<Vec<Dataset>>>()
    })?;
    file.step(|_| {
        let mut all = datasets.iter().zip(&columns).zip(&turned);
        all.try_for_each(|((dataset, (_, width)), values)| write_field(dataset, grid, *width, values))
    })
}

/// The checksum of the values of this rank's block, the first axis running fastest.
fn field_checksum<const D: usize>(grid: &Grid<D>, width: usize, values: &[f64]) -> u64 {
    let (block, cells) = (grid.block(D), grid.cells());
    let lengths: [usize; D] = std::array::from_fn(|axis| block.end[axis] - block.start[axis]);
    let place = |mut number: usize| {
        let index: [usize; D] = std::array::from_fn(|axis| {
            let own = number % lengths[axis];
            number /= lengths[axis];
            block.start[axis] + own
        });
        (0..D).rev().fold(0, |place, axis| place * cells[axis] + index[axis])
    };
    let entries = (0..values.len() / width).flat_map(|number| (place(number) * width..).take(width));
    checksum(entries.zip(values.iter().map(|value| value.to_bits())))
}

/// Writes the values of this rank's block, the first axis running fastest.
fn write_field<const D: usize>(dataset: &Dataset, grid: &Grid<D>, width: usize, values: &[f64]) -> hdf5::Result<()> {
    let mut ranges = slab::ranges(grid.block(D), grid.lattice(D));
    ranges.extend((D == 2).then_some(0..1));
    ranges.reverse();
    ranges.extend((width > 1).then_some(0..width));
    slab::write(dataset, &ranges, values)
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
