//! Solves with sparse symmetric matrices by their factors.

use std::ptr::null_mut;

use super::{Matrix, RowBuilder, Session, Vector, ffi, owned::Owned, petsc};
use crate::error::{Error, Result};

/// What is known of the signs of a symmetric matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Definiteness {
    /// Positive.
    Positive,
    /// Positive on some unknowns and negative on the others.
    Quasi,
}

/// The factors of a symmetric matrix, which all ranks share.
pub struct Symmetric {
    solver: Owned<ffi::KSP>,
    _matrix: Matrix,
}

impl Symmetric {
    /// Factors the matrix of this rank's rows, of which there are `local`, by CHOLMOD if it is positive and on one rank, or else by MUMPS; PETSc options with the prefix `network_` adjust it.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the matrix has no such factors.
    pub fn new(session: &Session, (local, rows): (usize, RowBuilder), definiteness: Definiteness) -> Result<Symmetric> {
        let matrix = Matrix::from_rows(session, local, rows)?;
        let positive = definiteness == Definiteness::Positive;
        let kind = if positive { ffi::MatOption_MAT_SPD } else { ffi::MatOption_MAT_SYMMETRIC };
        petsc!(MatSetOption(matrix.raw(), kind, ffi::PetscBool_PETSC_TRUE))?;
        let (mut raw, mut pc) = (null_mut(), null_mut());
        petsc!(KSPCreate(session.communicator(), &mut raw))?;
        let solver = Owned::new(session, raw);
        petsc!(KSPSetOptionsPrefix(raw, c"network_".as_ptr()))?;
        petsc!(KSPSetOperators(raw, matrix.raw(), matrix.raw()))?;
        petsc!(KSPSetType(raw, c"preonly".as_ptr()))?;
        petsc!(KSPGetPC(raw, &mut pc))?;
        petsc!(PCSetType(pc, c"cholesky".as_ptr()))?;
        let package = if positive && session.world().size() == 1 { c"cholmod" } else { c"mumps" };
        petsc!(PCFactorSetMatSolverType(pc, package.as_ptr()))?;
        petsc!(KSPSetFromOptions(raw))?;
        petsc!(KSPSetUp(raw))?;
        let mut reason = ffi::PCFailedReason_PC_NOERROR;
        petsc!(PCGetFailedReason(pc, &mut reason))?;
        if reason != ffi::PCFailedReason_PC_NOERROR {
            return Err(Error::Diverged("the resistances of contacts and films cannot be factored".into()));
        }
        Ok(Symmetric { solver, _matrix: matrix })
    }

    /// Solves `A x = rhs`.
    pub fn solve(&mut self, rhs: &Vector, x: &mut Vector) -> Result<()> {
        petsc!(KSPSolve(self.solver.raw(), rhs.raw(), x.raw()))
    }
}
