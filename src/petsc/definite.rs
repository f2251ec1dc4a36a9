//! Solves with sparse symmetric positive matrices by their Cholesky factors.

use std::ptr::null_mut;

use super::{Matrix, RowBuilder, Session, Vector, ffi, owned::Owned, petsc};
use crate::error::{Error, Result};

/// The Cholesky factors of a symmetric positive matrix, which all ranks share.
pub struct Definite {
    solver: Owned<ffi::KSP>,
    _matrix: Matrix,
}

impl Definite {
    /// Factors the matrix of this rank's rows, of which there are `local`; PETSc options with the prefix `network_` adjust it.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the matrix has no such factors.
    pub fn new(session: &Session, local: usize, rows: RowBuilder) -> Result<Definite> {
        let matrix = Matrix::from_rows(session, local, rows)?;
        petsc!(MatSetOption(matrix.raw(), ffi::MatOption_MAT_SPD, ffi::PetscBool_PETSC_TRUE))?;
        let (mut raw, mut pc) = (null_mut(), null_mut());
        petsc!(KSPCreate(session.communicator(), &mut raw))?;
        let solver = Owned::new(session, raw);
        petsc!(KSPSetOptionsPrefix(raw, c"network_".as_ptr()))?;
        petsc!(KSPSetOperators(raw, matrix.raw(), matrix.raw()))?;
        petsc!(KSPSetType(raw, c"preonly".as_ptr()))?;
        petsc!(KSPGetPC(raw, &mut pc))?;
        petsc!(PCSetType(pc, c"cholesky".as_ptr()))?;
        let package = if session.world().size() > 1 { c"mumps" } else { c"cholmod" };
        petsc!(PCFactorSetMatSolverType(pc, package.as_ptr()))?;
        petsc!(KSPSetFromOptions(raw))?;
        petsc!(KSPSetUp(raw))?;
        let mut reason = ffi::PCFailedReason_PC_NOERROR;
        petsc!(PCGetFailedReason(pc, &mut reason))?;
        if reason != ffi::PCFailedReason_PC_NOERROR {
            return Err(Error::Diverged("the resistances of contacts and films cannot be factored".into()));
        }
        Ok(Definite { solver, _matrix: matrix })
    }

    /// Solves `A x = rhs`.
    pub fn solve(&mut self, rhs: &Vector, x: &mut Vector) -> Result<()> {
        petsc!(KSPSolve(self.solver.raw(), rhs.raw(), x.raw()))
    }
}
