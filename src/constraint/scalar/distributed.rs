//! The distributed method: the scalar is one unknown constant at every cell centre in the inclusion.
//!
//! The multipliers are sources in these cells. Where they alone hold the constant, the inverse of what they bring about is the
//! Laplacian between them plus what the outside takes through the surface. The first alone stands for it: the outside takes no
//! more than a multiple, independent of the grid, of what the inclusion itself would pass on.

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
