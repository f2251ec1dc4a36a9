//! Blocks of an inclusion whose multipliers are sources in cells.

use nalgebra::DMatrix;

use super::{
    blocks::InclusionBlocks,
    coupling::{Cells, Coupling},
    links::{LinkedCells, filled_parts},
};
use crate::{
    constraint::{Layout, rows::Rows},
    geometry::Ball,
    grid::Grid,
};

/// The blocks of an inclusion, with its number, from its cells and their coupling.
pub fn blocks<const D: usize>(
    grid: &Grid<D>,
    layout: &Layout,
    (body, ball): (usize, &Ball<D>),
    (linked, cells): (&LinkedCells<D>, Cells),
) -> InclusionBlocks {
    let (first, count) = (layout.local(body), linked.unknowns.len());
    let (unknowns, parts) = filled_parts(grid, ball);
    InclusionBlocks {
        range: first..first + count,
        constant: vec![1.0; count],
        positions: DMatrix::from_fn(count, D, |cell, axis| linked.offsets[cell][axis]),
        measure: grid.spacing().product(),
        // a source of strength 1 all over the inclusion flows out with strength a/D
        reaction: ball.radius * ball.radius / D as f64,
        source: Rows::new(unknowns, parts),
        coupling: Coupling::Cells(cells),
    }
}
