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

use super::{cells::blocks, graph::CellGraph, inclusion::InclusionBlocks};
use crate::{
    constraint::{
        adjoint::Distributed,
        method::{Method, Size},
        placed::Surrounded,
    },
    geometry::Ball,
    grid::Grid,
};

impl<const D: usize> Method<D, InclusionBlocks<D>> for Distributed {
    fn description(&self) -> String {
        "with a multiplier in each cell inside (distributed)".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<InclusionBlocks<D>> {
        let of = |ball: Ball<D>| {
            let covered = CellGraph::covered(grid, &ball);
            let edges = covered.edges.clone();
            blocks(grid, &ball, covered, None, edges)
        };
        bodies.iter().map(|body| of(body.placed.ball())).collect()
    }

    fn bytes(&self, _grid: &Grid<D>, size: &Size<D>) -> f64 {
        32.0 * D as f64 * size.count as f64
    }

    fn count(&self, grid: &Grid<D>, ball: &Ball<D>, _modes: usize) -> usize {
        CellGraph::covered(grid, ball).unknowns.len()
    }

    fn on_surfaces(&self) -> bool {
        false
    }
}
