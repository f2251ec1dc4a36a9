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
    LATTICE_BYTES,
    body::AdjointBody,
    elastic::ElasticInverse,
    equations::{Equations, RowEquations, ScaledElastic},
    inertia::AdjointMethod,
    rigid::{motions, push_readings},
    strains::{Strain, Strains},
};
use crate::{
    constraint::{
        body::BodyBlocks,
        method::{Method, Size},
        placed::{Placed, Surrounded},
    },
    geometry::{Ball, fraction},
    grid::Grid,
    linalg::SparseRows,
};

/// Default of `epsilon`.
///
/// The drag of the square array at 0.3 lacks 2 epsilon of its value on every grid, and the grid itself errs by more than 5e-4 up to 80 cells
/// a radius; solves take the same iterations from 1e-4 down to 1e-10. The value in a disk of the scalar problem is wrong by about
/// `0.06 epsilon` besides what the grid makes of it, which goes down as `h^2` at best and is 1e-5 with 512 cells a side.
const EPSILON: f64 = 1e-6;

/// The method.
#[derive(Debug, Clone, Copy)]
pub struct Penalty {
    /// Viscosity of the fluid over that inside, or one over the conductivity inside.
    pub epsilon: f64,
    /// Of the operator of the fluid; 0 without inertia.
    pub shift: f64,
}

impl Penalty {
    /// With its own choice of epsilon unless one is given, for an operator with a shift.
    pub fn new(epsilon: Option<f64>, shift: f64) -> Penalty {
        Penalty { epsilon: epsilon.unwrap_or(EPSILON), shift }
    }
}

impl<const D: usize> Method<D, Box<dyn BodyBlocks<D>>> for Penalty {
    fn description(&self) -> String {
        format!("1/{:e} times as viscous inside, with Cholesky factors of each (penalty)", self.epsilon)
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        bodies.iter().map(|body| Box::new(self.body(grid, body.placed)) as Box<_>).collect()
    }

    /// Rows of strains, and the factors of an elastic body, of which a row spans a slice.
    fn bytes(&self, _grid: &Grid<D>, size: &Size<D>) -> f64 {
        4.0 * LATTICE_BYTES * size.count as f64 + 8.0 * (size.count as f64).powf(2.0 - 1.0 / D as f64)
    }

    fn count(&self, grid: &Grid<D>, ball: &Ball<D>, _modes: usize) -> usize {
        D * (D + 1) / 2 + Strains::of(grid, ball).strains.len()
    }

    fn on_surfaces(&self) -> bool {
        false
    }
}

impl<const D: usize> AdjointMethod<D> for Penalty {
    fn body(&self, grid: &Grid<D>, placed: &Placed<D>) -> AdjointBody<D> {
        assemble(grid, placed, *self)
    }
}

/// The blocks of one body.
fn assemble<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, Penalty { epsilon, shift }: Penalty) -> AdjointBody<D> {
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
        inverse: Rc::new(ScaledElastic {
            inverse: ElasticInverse::new(&nodes, plain, &divergences, &compliances, shift),
            scales: balances.iter().map(|balance| std::f64::consts::SQRT_2 * balance).collect(),
        }),
    };
    let cell = grid.spacing().product();
    AdjointBody { nodes, rows, wall_values: Vec::new(), equations: Equations::Rows(equations), cell, interior: None }
}
