//! The `penalty` method: fluid inside a body that is `1/epsilon` times as viscous.
//!
//! Where the ball fills the part `theta` of the cell around a strain, normal strains at cell centres and shear strains at
//! edges, the viscosity is `m = 1/((1 - theta) + theta epsilon)`. What it adds to the stress, `2 (m - 1) D(u)`, is the
//! multiplier:
//!
//! ```text
//! J u = D(u) without its trace,      C = J^T S (its divergence),      E = S/(2 (m - 1))
//! ```
//!
//! so that the matrix stays that of the box whatever `epsilon` is: `J K^-1 J^T` has its spectrum between 0 and 1/2.
//! Series averaging, as above, errs by 0.5 % where averaging in parallel, `1 + theta (1/epsilon - 1)`, errs by 46 %
//! (drag of the square array at 0.3, ten cells a radius): in parallel, a trace of a body makes a cell rigid.
//! Forces and weight are spread over the body by `theta`, and its motion is the mean over it.

use std::iter::once;

use super::{
    AdjointBody,
    nodes::{Collector, SparseRows, within_walls},
    rigid::{motions, push_readings},
    test::{RowTest, Test},
};
use crate::{
    constraint::{patch::Patch, sharp::Placed},
    geometry::{Ball, fraction},
    grid::{
        Grid, Index,
        stencil::{Site, divergence, moved},
    },
};

/// Parts of a cell that are too small to matter.
const TRACE: f64 = 1e-4;

/// A typical eigenvalue of `J K^-1 J^T S`, which lie between 0 and 1.
const TYPICAL: f64 = 0.5;

/// A strain, `D(u)` in one place as a sum over nodes, and the part of its cell that is in the body.
struct Strain {
    terms: Vec<(u32, f64)>,
    theta: f64,
}

/// The blocks of one body.
pub fn assemble<const D: usize>(grid: &Grid<D>, (body, placed): (usize, &Placed<D>), epsilon: f64) -> AdjointBody<D> {
    let ball = Ball { center: placed.center, radius: placed.surface.modes.radius() };
    let mut collector = Collector::new(grid, placed.center);
    let mut strains = normal_strains(grid, &ball, &mut collector);
    for (first, second) in (0..D).flat_map(|second| (0..second).map(move |first| (first, second))) {
        strains.extend(shear_strains(grid, &ball, [first, second], &mut collector));
    }
    let (nodes, surface) = (collector.nodes, &placed.surface);
    let filled = |offset| fraction(&ball, &(placed.center + offset), &grid.spacing());
    let mut rows = SparseRows::default();
    push_readings(&motions(surface, &nodes), &nodes.offsets.iter().map(filled).collect::<Vec<f64>>(), &mut rows);
    // a velocity, so that the residual is a mean over the body
    let weight = ball.radius * (grid.mean_spacing() / ball.radius).powf(0.5 * D as f64);
    let mut compliances = Vec::with_capacity(strains.len());
    for Strain { terms, theta } in strains {
        let compliance = ((1.0 - theta) + theta * epsilon) / (theta * (1.0 - epsilon));
        // both its row and its multiplier are scaled so that the diagonal is 1
        let balance = 1.0 / (TYPICAL + compliance).sqrt();
        rows.push(terms.into_iter().map(|(node, factor)| (node, weight * balance * factor)));
        compliances.push(compliance * balance * balance);
    }
    let cell = grid.spacing().product();
    let test = RowTest {
        rigid: surface.modes.rigid_count(),
        motions: nalgebra::DMatrix::zeros(0, 0),
        strengths: [surface.modes.force_factor() / cell, 2.0 / (weight * weight)],
        inverse: vec![1.0; compliances.len()],
        compliance: compliances,
    };
    AdjointBody { body, center: placed.center, nodes, rows, wall_values: Vec::new(), test: Test::Rows(test), cell }
}

/// Normal strains at cell centres, in an orthonormal basis of those without trace.
fn normal_strains<const D: usize>(grid: &Grid<D>, ball: &Ball<D>, collector: &mut Collector<D>) -> Vec<Strain> {
    let mut strains = Vec::new();
    for index in Patch::around(grid, D, &ball.center, ball.radius + grid.spacing().max()).indices() {
        let theta = fraction(ball, &grid.position(D, index), &grid.spacing());
        if theta < TRACE {
            continue;
        }
        for last in 1..D {
            let norm = ((last * (last + 1)) as f64).sqrt();
            let weighed = (0..last).map(|axis| (axis, 1.0 / norm)).chain(once((last, -(last as f64) / norm)));
            let terms =
                weighed.flat_map(|(axis, factor)| divergence(grid, axis, index).map(|term| (axis, term.site, factor * term.weight)));
            let node = |(axis, site, weight)| match site {
                Site::Lattice { index, .. } => Some((collector.node(axis, index)?, weight)),
                Site::Wall { .. } => None,
            };
            strains.push(Strain { terms: terms.filter_map(node).collect(), theta });
        }
    }
    strains
}

/// Shear strains in a plane of axes, at edges; there are none on walls.
fn shear_strains<const D: usize>(grid: &Grid<D>, ball: &Ball<D>, [first, second]: [usize; 2], collector: &mut Collector<D>) -> Vec<Strain> {
    let mut strains = Vec::new();
    for index in Patch::around(grid, first, &ball.center, ball.radius + 1.5 * grid.spacing().max()).indices() {
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
