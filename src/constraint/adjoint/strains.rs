//! Strains in and near a ball, at the points where a staggered grid has them.

use std::iter::once;

use super::nodes::{AdjointNodes, Collector, within_walls};
use crate::{
    constraint::{index_box::IndexBox, unknowns::Unknowns},
    geometry::{Ball, fraction},
    grid::{
        Grid, Index,
        stencil::{Site, divergence, moved},
    },
    linalg::SparseRows,
};

/// Parts of a cell that are too small to matter.
const TRACE: f64 = 1e-4;

/// A strain in one place as a sum over nodes, and the part of its cell that is in the ball.
pub struct Strain {
    /// Nodes and weights.
    pub terms: Vec<(u32, f64)>,
    /// Above 0, at most 1.
    pub theta: f64,
}

/// The strains `D(u)` without trace in cells that meet a ball, in an orthonormal basis.
pub struct Strains<const D: usize> {
    /// The velocities that they take.
    pub nodes: AdjointNodes<D>,
    /// Normal strains at cell centres, then shear strains at edges.
    pub strains: Vec<Strain>,
    /// The divergence at the same cell centres.
    pub divergences: SparseRows,
}

impl<const D: usize> Strains<D> {
    /// Those of a ball.
    pub fn of(grid: &Grid<D>, ball: &Ball<D>) -> Strains<D> {
        let mut collector = Collector::new(grid, Unknowns::Fluid, ball.center);
        let (mut strains, mut divergences) = (Vec::new(), SparseRows::default());
        for index in IndexBox::around(grid, D, &ball.center, ball.radius + grid.spacing().max()).indices() {
            let theta = fraction(ball, &grid.position(D, index), &grid.spacing());
            if theta > TRACE {
                let slopes: [Vec<(u32, f64)>; D] = std::array::from_fn(|axis| slope(grid, axis, index, &mut collector));
                strains.extend((1..D).map(|last| Strain { terms: without_trace(&slopes, last), theta }));
                divergences.push(slopes.into_iter().flatten());
            }
        }
        for plane in (0..D).flat_map(|second| (0..second).map(move |first| [first, second])) {
            strains.extend(shear_strains(grid, ball, plane, &mut collector));
        }
        Strains { nodes: collector.nodes, strains, divergences }
    }
}

/// The derivative along its own axis of a component of the velocity at a cell centre.
fn slope<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>, collector: &mut Collector<D>) -> Vec<(u32, f64)> {
    let node = |(site, weight)| match site {
        Site::Lattice { index, .. } => Some((collector.node(axis, index)?, weight)),
        Site::Wall { .. } => None,
    };
    divergence(grid, axis, index).map(|term| (term.site, term.weight)).filter_map(node).collect()
}

/// The strain in which the axes before `last` stretch alike and it shrinks as much as all of them together.
fn without_trace<const D: usize>(slopes: &[Vec<(u32, f64)>; D], last: usize) -> Vec<(u32, f64)> {
    let norm = ((last * (last + 1)) as f64).sqrt();
    let weighed = (0..last).map(|axis| (axis, 1.0 / norm)).chain(once((last, -(last as f64) / norm)));
    weighed.flat_map(|(axis, factor)| slopes[axis].iter().map(move |&(node, weight)| (node, factor * weight))).collect()
}

/// Shear strains in a plane of axes, at edges; there are none on walls.
fn shear_strains<const D: usize>(grid: &Grid<D>, ball: &Ball<D>, [first, second]: [usize; 2], collector: &mut Collector<D>) -> Vec<Strain> {
    let mut strains = Vec::new();
    for index in IndexBox::around(grid, first, &ball.center, ball.radius + 1.5 * grid.spacing().max()).indices() {
        let mut center = grid.position(first, index);
        center[second] -= 0.5 * grid.spacing()[second];
        let theta = fraction(ball, &center, &grid.spacing());
        let sides = [(first, second), (second, first)].map(|(component, along)| (component, moved(index, along, -1), along));
        if theta < TRACE || !sides.iter().all(|&(component, before, _)| between_walls(grid, component, [before, index])) {
            continue;
        }
        let terms = sides.into_iter().flat_map(|(component, before, along)| {
            let weight = std::f64::consts::FRAC_1_SQRT_2 / grid.spacing()[along];
            [(component, before, -weight), (component, index, weight)]
        });
        let node = |(component, index, weight)| Some((collector.node(component, index)?, weight));
        strains.push(Strain { terms: terms.filter_map(node).collect(), theta });
    }
    strains
}

fn between_walls<const D: usize>(grid: &Grid<D>, component: usize, ends: [Index<D>; 2]) -> bool {
    ends.into_iter().all(|index| within_walls(grid, component, index))
}
