//! Condition numbers of the constrained problem: the fluid is eliminated, what is left are the multipliers of free disks.
//!
//! Multipliers act on velocities like the inverse of a derivative on the circle: the mode of order k feels `1/k`, so the condition
//! number grows like the number of modes and does not feel the grid. The preconditioner knows how, for each body alone and each near pair.

use nalgebra::{SMatrix, SVector, Vector2};
use serde::Serialize;

use super::growth::Exponent;
use crate::{
    body::{Body, Motion},
    error::Result,
    flow::{Drive, InverseMethod},
    geometry::{Axis, Ball, Domain},
    mechanics::Suspension,
    petsc::Session,
    scene::{ConstraintMethod, Tolerance},
    setup::{Setup, SuspendedBody},
};

/// Cells per side of the box.
const GRIDS: [usize; 3] = [32, 64, 128];

/// Order of the modes on all grids.
const ORDER: usize = 4;

/// Orders on the finest of the grids.
const ORDERS: [usize; 4] = [3, 6, 8, 12];

/// Disks in a periodic box, on one grid, with modes of one order.
#[derive(Debug, Clone, Serialize)]
pub struct Constrained {
    /// Disks.
    pub bodies: usize,
    /// Cells per side of the box.
    pub cells: usize,
    /// Radius in cells.
    pub cells_per_radius: f64,
    /// Highest order of the modes.
    pub modes: usize,
    /// Multipliers.
    pub unknowns: usize,
    /// Condition number of the operator on the multipliers.
    pub condition: f64,
    /// The same with the solver's preconditioner.
    pub preconditioned: f64,
}

/// How the condition number of so many disks grows.
#[derive(Debug, Clone, Serialize)]
pub struct MultiplierGrowth {
    /// Disks.
    pub bodies: usize,
    /// Exponent of `1/h` at the same modes.
    pub grid: Exponent,
    /// Exponent of `K + 1` on the same grid, for modes up to order K.
    pub modes: Exponent,
}

impl MultiplierGrowth {
    /// Those of all numbers of disks.
    pub fn of(rows: &[Constrained]) -> Vec<MultiplierGrowth> {
        rows.chunks(GRIDS.len() + ORDERS.len()).map(MultiplierGrowth::of_one).collect()
    }

    fn of_one(rows: &[Constrained]) -> MultiplierGrowth {
        let (by_grid, by_order) = rows.split_at(GRIDS.len());
        let points = |rows: &[Constrained], abscissa: fn(&Constrained) -> f64| -> Vec<(f64, f64)> {
            rows.iter().map(|row| (abscissa(row), row.condition)).collect()
        };
        MultiplierGrowth {
            bodies: rows[0].bodies,
            grid: Exponent::of(&points(by_grid, |row| row.cells as f64), 0.0),
            modes: Exponent::of(&points(by_order, |row| (row.modes + 1) as f64), 1.0),
        }
    }
}

/// All grids, then all orders on the finest, for one disk and for several.
///
/// # Errors
/// The rank count does not fit.
pub fn constrained(session: &Session) -> Result<Vec<Constrained>> {
    let by_grid = GRIDS.map(|cells| (cells, ORDER));
    let by_order = ORDERS.map(|order| (GRIDS[GRIDS.len() - 1], order));
    let mut rows = Vec::new();
    for disks in [one(), nine()] {
        for (cells, order) in by_grid.into_iter().chain(by_order) {
            rows.push(row(session, &disks, cells, order)?);
        }
    }
    Ok(rows)
}

fn row(session: &Session, disks: &[Ball<2>], cells: usize, order: usize) -> Result<Constrained> {
    let motion = Motion::Free { force: SVector::zeros(), torque: SMatrix::zeros() };
    let found = Suspension::new(session, periodic(disks, motion, cells, order))?.conditions()?;
    Ok(Constrained {
        bodies: disks.len(),
        cells,
        cells_per_radius: disks[0].radius * cells as f64,
        modes: order,
        unknowns: found.unknowns,
        condition: found.plain,
        preconditioned: found.preconditioned,
    })
}

/// Disks in a periodic box of side 1 that is sheared.
pub fn periodic(disks: &[Ball<2>], motion: Motion<2>, cells: usize, order: usize) -> Setup<2> {
    Setup {
        domain: Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; 2] },
        spacing: 1.0 / cells as f64,
        viscosity: 1.0,
        drive: Drive::Shear(1.0),
        bodies: disks.iter().map(|&ball| SuspendedBody { body: Body { ball, motion }, order }).collect(),
        inertia: None,
        changing_drive: None,
        trajectories: Default::default(),
        constraint: ConstraintMethod::Sharp,
        interactions: crate::interaction::Interactions::default(),
        inverse: InverseMethod::Transform,
        tolerance: Tolerance::Auto,
    }
}

/// A disk in no special place on any grid.
pub fn one() -> Vec<Ball<2>> {
    vec![Ball { center: Vector2::new(0.513, 0.527), radius: 0.2 }]
}

/// Disks that fill 0.36 of the box, about a lattice, with narrow gaps and wide ones.
fn nine() -> Vec<Ball<2>> {
    let disk = |place: usize| {
        let (column, row) = ((place % 3) as f64, (place / 3) as f64);
        let shift = 0.03 * Vector2::new((5.0 * column + 9.0 * row).sin(), (7.0 * column + 4.0 * row).cos());
        Ball { center: Vector2::new(column + 0.513, row + 0.527) / 3.0 + shift, radius: 0.113 }
    };
    (0..9).map(disk).collect()
}
