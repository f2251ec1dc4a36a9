//! The mean-value method: flux multipliers on the surface, on which the scalar is interpolated linearly.
//!
//! Tested with the modes, the scalar on the surface differs from its mean by nothing: `integral of psi (u - m(u)) = 0`. C is the adjoint
//! of J: each multiplier is spread to the cells whose values make up its point. Stencils are not corrected for the jump of the slope, so
//! that the method is of first order.

use std::collections::BTreeSet;

use super::{
    graph::filled_parts,
    inclusion::{Inclusion, InclusionBlocks},
    sharp,
};
use crate::{
    constraint::{
        adjoint::{MeanValue, mean_value},
        method::{Method, Size},
        placed::{Placed, Surrounded},
        rows::Rows,
    },
    grid::Grid,
};

impl<const D: usize> Method<D, InclusionBlocks<D>> for MeanValue {
    fn description(&self) -> String {
        "with surface multipliers and linear interpolation (mean-value)".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<InclusionBlocks<D>> {
        let blocks = |&Surrounded { placed, .. }: &Surrounded<D>| {
            let body = mean_value::assemble(grid, placed);
            let source = source(grid, placed, body.nodes.unknowns());
            InclusionBlocks { body: Box::new(body), inclusion: Inclusion::on_surface(placed, source, Vec::new()) }
        };
        bodies.iter().map(blocks).collect()
    }

    fn bytes(&self, _grid: &Grid<D>, size: &Size<D>) -> f64 {
        sharp::bytes(size)
    }
}

/// Minus the parts of cells in the inclusion, and nothing for the other cells to which its multipliers are spread.
fn source<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, spread: &[usize]) -> Rows {
    let (mut unknowns, mut parts) = filled_parts(grid, &placed.ball());
    let inside: BTreeSet<usize> = unknowns.iter().copied().collect();
    unknowns.extend(spread.iter().filter(|unknown| !inside.contains(unknown)));
    parts.resize(unknowns.len(), 0.0);
    Rows::new(unknowns, parts)
}
