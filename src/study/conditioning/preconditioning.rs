//! The preconditioners that are compared.

use serde::Serialize;

use super::energy::InverseOperator;
use crate::{
    error::Result,
    petsc::{Amg, AmgSettings, Matrix, Preconditioner, PreconditionerKind},
};

/// A preconditioner of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioning {
    /// None.
    None,
    /// The diagonal.
    Jacobi,
    /// Incomplete Cholesky factors.
    IncompleteCholesky,
    /// BoomerAMG as PETSc gives it.
    DefaultAmg,
    /// BoomerAMG as the fluid solver uses it, with backward sweeps on the way up: conjugate gradients need a symmetric cycle.
    TunedAmg,
}

impl Preconditioning {
    /// All, in the order of the tables.
    pub const ALL: [Preconditioning; 5] = [
        Preconditioning::None,
        Preconditioning::Jacobi,
        Preconditioning::IncompleteCholesky,
        Preconditioning::DefaultAmg,
        Preconditioning::TunedAmg,
    ];

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Preconditioning::None => "none",
            Preconditioning::Jacobi => "Jacobi",
            Preconditioning::IncompleteCholesky => "incomplete Cholesky",
            Preconditioning::DefaultAmg => "BoomerAMG, default",
            Preconditioning::TunedAmg => "BoomerAMG, tuned",
        }
    }

    /// Whether it is multigrid, with iterations that are not to feel the grid.
    pub fn multigrid(self) -> bool {
        matches!(self, Preconditioning::DefaultAmg | Preconditioning::TunedAmg)
    }

    /// Sets it up for a matrix.
    ///
    /// # Errors
    /// Memory is short.
    pub fn set_up(self, matrix: &Matrix, dimension: usize) -> Result<InverseOperator> {
        let kind = match self {
            Preconditioning::None => return Ok(Box::new(|input, output| output.copy_from(input))),
            Preconditioning::TunedAmg => {
                let amg = Amg::new(matrix, false, &AmgSettings::laplacian(dimension).symmetric())?;
                return Ok(Box::new(move |input, output| amg.apply(input, output)));
            }
            Preconditioning::Jacobi => PreconditionerKind::Jacobi,
            Preconditioning::IncompleteCholesky => PreconditionerKind::IncompleteCholesky,
            Preconditioning::DefaultAmg => PreconditionerKind::BoomerAmg,
        };
        let preconditioner = Preconditioner::new(matrix, kind)?;
        Ok(Box::new(move |input, output| preconditioner.apply(input, output)))
    }
}
