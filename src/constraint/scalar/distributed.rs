//! The distributed method: the scalar is one unknown constant at every cell centre in the inclusion.
//!
//! The multipliers are sources in these cells. Where they alone hold the constant, the inverse of what they bring about is the
//! Laplacian between them plus what the outside takes through the surface. The first alone stands for it: the outside takes no
//! more than a multiple, independent of the grid, of what the inclusion itself would pass on.
//!
//! The other way is to eliminate the cells: `P^T A P` with one unknown for all of them. Measured on a disk in the unit square with 32, 64,
//! 128 and 256 cells a side, to 1e-8: conjugate gradients for `P^T A P`, preconditioned by `P^+ A^{-1} P^+^T` with the exact inverse of
//! the box, take 13, 17, 23 and 31 iterations; the multipliers 20, 21, 21 and 22, with a multigrid cycle in the place of the inverse.
//! A hierarchy of `P^T A P` itself would be another one for each place of the inclusions.

use super::{blocks::InclusionBlocks, cells::blocks, coupling::Cells, links::LinkedCells};
use crate::{constraint::Layout, geometry::Ball, grid::Grid};

/// The blocks of an inclusion, with its number.
pub fn assemble<const D: usize>(grid: &Grid<D>, layout: &Layout, (body, ball): (usize, &Ball<D>)) -> InclusionBlocks {
    let covered = LinkedCells::covered(grid, ball);
    let cells = Cells { unknowns: covered.unknowns.clone(), places: Default::default(), compliance: None, links: covered.links.clone() };
    blocks(grid, layout, (body, ball), (&covered, cells))
}

/// Number of multipliers of an inclusion.
pub fn count<const D: usize>(grid: &Grid<D>, ball: &Ball<D>) -> usize {
    LinkedCells::covered(grid, ball).unknowns.len()
}
