//! The mean-value method: flux multipliers on the surface, on which the scalar is interpolated linearly.
//!
//! Tested with the modes, the scalar on the surface differs from its mean by nothing: `integral of psi (u - m(u)) = 0`. C is the adjoint
//! of J: each multiplier is spread to the cells whose values make up its point. Stencils are not corrected for the jump of the slope, so
//! that the method is of first order.

use nalgebra::SVector;

use super::{
    PlacedInclusion,
    blocks::InclusionBlocks,
    coupling::{Coupling, Modes},
    links::filled_parts,
    sharp::measures,
};
use crate::{
    constraint::{Layout, patch::Patch, rows::Rows},
    grid::{
        Grid, Index, Node, dirichlet,
        interpolation::{Pair, linear},
    },
};

/// The place of a cell that has none.
const EMPTY: usize = usize::MAX;

/// The blocks of an inclusion, with its number.
pub fn assemble<const D: usize>(grid: &Grid<D>, layout: &Layout, (body, inclusion): (usize, &PlacedInclusion<D>)) -> InclusionBlocks {
    let surface = inclusion.surface();
    let (radius, count) = (inclusion.ball.radius, surface.modes.count());
    let (area, _) = measures::<D>(radius);
    let sampled = interpolation(grid, inclusion);
    let spread = sampled.values.iter().map(|value| value * area / grid.spacing().product()).collect();
    let rows = Rows::new(sampled.unknowns.clone(), spread);
    let first = layout.local(body);
    let values = surface.modes.isolated_values();
    InclusionBlocks {
        range: first..first + count,
        constant: surface.constant(),
        positions: surface.mean_moments().columns(1, D) * radius,
        measure: area,
        reaction: values[0],
        source: source(grid, inclusion, &sampled.unknowns),
        coupling: Coupling::Modes(Modes { rows, sampled, by_source: vec![0.0; count], values: values.into(), ..Modes::default() }),
    }
}

/// The rows of the transpose of J.
fn interpolation<const D: usize>(grid: &Grid<D>, inclusion: &PlacedInclusion<D>) -> Rows {
    let (projector, count) = (inclusion.surface().projector(), inclusion.surface().modes.count());
    let patch = Patch::around(grid, D, &inclusion.ball.center, inclusion.ball.radius + 2.0 * grid.spacing().max());
    let (mut columns, mut rows) = (vec![EMPTY; patch.len()], Rows::default());
    for (offset, tests) in inclusion.surface().offsets().zip(projector.column_iter()) {
        each_corner(grid, &(inclusion.ball.center + offset), |index, weight| {
            let Some(Node::Unknown(unknown)) = dirichlet::within(grid, index).then(|| grid.node(D, index)) else { return };
            let column = &mut columns[patch.place(index)];
            if *column == EMPTY {
                *column = rows.unknowns.len();
                rows.unknowns.push(unknown as u32);
                rows.values.resize(rows.unknowns.len() * count, 0.0);
            }
            let values = &mut rows.values[*column * count..][..count];
            values.iter_mut().zip(tests.iter()).for_each(|(value, test)| *value += weight * test);
        });
    }
    rows
}

/// Visits the cells around a point with their weights; points of walls, where the scalar is zero, have indices beyond the cells.
fn each_corner<const D: usize>(grid: &Grid<D>, point: &SVector<f64, D>, mut visit: impl FnMut(Index<D>, f64)) {
    let pairs: [Pair; D] = std::array::from_fn(|axis| linear(grid, D, axis, point[axis]));
    for corner in 0..1 << D {
        let side = |axis: usize| (corner >> axis) & 1;
        let weight = (0..D).map(|axis| pairs[axis].weights[side(axis)]).product();
        visit(std::array::from_fn(|axis| pairs[axis].first + side(axis) as isize), weight);
    }
}

/// Minus the parts of cells in the inclusion, and nothing for the other cells to which its multipliers are spread.
fn source<const D: usize>(grid: &Grid<D>, inclusion: &PlacedInclusion<D>, spread: &[u32]) -> Rows {
    let (mut unknowns, mut parts) = filled_parts(grid, &inclusion.ball);
    let inside: std::collections::BTreeSet<u32> = unknowns.iter().copied().collect();
    unknowns.extend(spread.iter().filter(|unknown| !inside.contains(unknown)));
    parts.resize(unknowns.len(), 0.0);
    Rows::new(unknowns, parts)
}
