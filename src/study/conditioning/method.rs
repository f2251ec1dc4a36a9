//! The preconditioners that are compared.

use serde::Serialize;

use super::energy::Inverse;
use crate::{
    error::Result,
    petsc::{Amg, AmgSettings, Matrix, Preconditioner, PreconditionerKind},
};

/// A preconditioner of the comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
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

impl Method {
    /// All, in the order of the tables.
    pub const ALL: [Method; 5] = [Method::None, Method::Jacobi, Method::IncompleteCholesky, Method::DefaultAmg, Method::TunedAmg];

    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Method::None => "none",
            Method::Jacobi => "Jacobi",
            Method::IncompleteCholesky => "incomplete Cholesky",
            Method::DefaultAmg => "BoomerAMG, default",
            Method::TunedAmg => "BoomerAMG, tuned",
        }
    }

    /// Whether it is multigrid, with iterations that are not to feel the grid.
    pub fn multigrid(self) -> bool {
        matches!(self, Method::DefaultAmg | Method::TunedAmg)
    }

    /// Sets it up for a matrix.
    ///
    /// # Errors
    /// Memory is short.
    pub fn set_up(self, matrix: &Matrix, dimension: usize) -> Result<Inverse> {
        let kind = match self {
            Method::None => return Ok(Box::new(|input, output| output.copy_from(input))),
            Method::TunedAmg => {
                let amg = Amg::new(matrix, false, &AmgSettings::laplacian(dimension).symmetric())?;
                return Ok(Box::new(move |input, output| amg.apply(input, output)));
            }
            Method::Jacobi => PreconditionerKind::Jacobi,
            Method::IncompleteCholesky => PreconditionerKind::IncompleteCholesky,
            Method::DefaultAmg => PreconditionerKind::BoomerAmg,
        };
        let preconditioner = Preconditioner::new(matrix, kind)?;
        Ok(Box::new(move |input, output| preconditioner.apply(input, output)))
    }
}
