//! Condition numbers of the other constraint methods for one free disk: the penalty against epsilon and the grid, multipliers against the grid.

use nalgebra::{SMatrix, SVector};
use serde::Serialize;

use super::multipliers::{one, periodic};
use crate::{
    body::Motion,
    error::Result,
    mechanics::Suspension,
    petsc::Session,
    scene::{ConstraintMethod, MultiplierSolver},
    setup::Setup,
};

/// Cells per side of the box.
const GRIDS: [usize; 3] = [16, 24, 32];

/// Penalties on the second of the grids.
const EPSILONS: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-8];

/// Order of the modes of the mean-value method.
const ORDER: usize = 3;

/// One disk, one method, one grid.
#[derive(Debug, Clone, Serialize)]
pub struct Rigidity {
    /// Word of the method.
    pub method: &'static str,
    /// Viscosity of the fluid over that inside, if the method has such a number.
    pub epsilon: Option<f64>,
    /// Cells per side of the box.
    pub cells: usize,
    /// Multipliers.
    pub unknowns: usize,
    /// Condition number of the operator on the multipliers.
    pub condition: f64,
    /// The same with the solver's preconditioner.
    pub preconditioned: f64,
}

/// The penalty for all values of epsilon, then each method on all grids.
///
/// # Errors
/// The rank count does not fit.
pub fn rigidity(session: &Session) -> Result<Vec<Rigidity>> {
    let penalties = EPSILONS.map(|epsilon| (ConstraintMethod::Penalty(Some(epsilon)), GRIDS[1]));
    let methods = [
        ConstraintMethod::Penalty(Some(EPSILONS[2])),
        ConstraintMethod::Distributed,
        ConstraintMethod::MeanValue(MultiplierSolver::Krylov),
    ];
    let on_grids = methods.into_iter().flat_map(|method| GRIDS.map(|cells| (method, cells)));
    penalties.into_iter().chain(on_grids).map(|(method, cells)| row(session, method, cells)).collect()
}

fn row(session: &Session, constraint: ConstraintMethod, cells: usize) -> Result<Rigidity> {
    let motion = Motion::Free { force: SVector::zeros(), torque: SMatrix::zeros() };
    let setup = Setup { constraint, ..periodic(&one(), motion, cells, ORDER) };
    let found = Suspension::new(session, setup)?.conditions()?;
    Ok(Rigidity {
        method: constraint.word(),
        epsilon: if let ConstraintMethod::Penalty(epsilon) = constraint { epsilon } else { None },
        cells,
        unknowns: found.unknowns,
        condition: found.plain,
        preconditioned: found.preconditioned,
    })
}
