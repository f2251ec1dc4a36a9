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

use std::rc::Rc;

use nalgebra::DMatrix;

use super::{
    AdjointBody,
    elastic::ElasticInverse,
    equations::{Equations, FreeInverse, RowEquations},
    rigid::{motions, push_readings},
    strains::{Strain, Strains},
};
use crate::{constraint::sharp::Placed, geometry::fraction, grid::Grid, linalg::SparseRows};

/// The blocks of one body.
pub fn assemble<const D: usize>(grid: &Grid<D>, (body, placed): (usize, &Placed<D>), epsilon: f64) -> AdjointBody<D> {
    let ball = placed.ball();
    let Strains { nodes, strains, divergences } = Strains::of(grid, &ball);
    let filled = |offset| fraction(&ball, &(placed.center + offset), &grid.spacing());
    let (mut rows, mut plain, motions) = (SparseRows::default(), SparseRows::default(), motions(&placed.surface, &nodes));
    push_readings(&motions, &nodes.offsets.iter().map(filled).collect::<Vec<f64>>(), &mut rows);
    // a velocity, so that the residual is a mean over the body
    let weight = ball.radius * (grid.mean_spacing() / ball.radius).powf(0.5 * D as f64);
    let (mut compliances, mut balances) = (Vec::new(), Vec::new());
    for Strain { terms, theta } in strains {
        // 1/(2 (m - 1))
        let compliance = 0.5 * ((1.0 - theta) + theta * epsilon) / (theta * (1.0 - epsilon));
        // rows and multipliers are scaled alike, so that none is large
        let balance = 1.0 / (0.5 + 2.0 * compliance).sqrt();
        rows.push(terms.iter().map(|&(node, factor)| (node, weight * balance * factor)));
        plain.push(terms);
        compliances.push(compliance);
        balances.push(balance);
    }
    let equations = RowEquations {
        rigid: motions.ncols(),
        motions: DMatrix::zeros(0, 0),
        strengths: [placed.surface.modes.force_factor() / grid.spacing().product(), 2.0 / (weight * weight)],
        others: compliances.len(),
        compliance: compliances.iter().zip(&balances).map(|(compliance, balance)| 2.0 * compliance * balance * balance).collect(),
        inverse: Rc::new(FreeInverse::Elastic {
            inverse: ElasticInverse::new(&nodes, plain, &divergences, &compliances),
            scales: balances.iter().map(|balance| std::f64::consts::SQRT_2 * balance).collect(),
        }),
    };
    let cell = grid.spacing().product();
    AdjointBody { body, center: placed.center, nodes, rows, wall_values: Vec::new(), equations: Equations::Rows(equations), cell }
}
