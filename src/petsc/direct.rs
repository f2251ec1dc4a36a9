//! Direct solves by MUMPS: factors that all ranks share.

use std::{ffi::CStr, ptr::null_mut};

use super::{Matrix, RowBuilder, Vector, ffi, owned::Owned, petsc};
use crate::error::{Error, Result};

/// Per cent of extra work space that MUMPS sets aside: pivots that come late make fronts grow beyond its estimate.
const SPARE_WORK_SPACE: ffi::PetscInt = 80;

/// MUMPS's number for that parameter.
const SPARE_WORK_SPACE_PARAMETER: ffi::PetscInt = 14;

/// Has MUMPS factor the matrix of a preconditioner, with room for pivots that come late.
pub(super) fn factor_by_mumps(pc: ffi::PC) -> Result<()> {
    let mut factors = null_mut();
    petsc!(PCFactorSetMatSolverType(pc, c"mumps".as_ptr()))?;
    petsc!(PCFactorSetUpMatSolverType(pc))?;
    petsc!(PCFactorGetMatrix(pc, &mut factors))?;
    petsc!(MatMumpsSetIcntl(factors, SPARE_WORK_SPACE_PARAMETER, SPARE_WORK_SPACE))
}

/// The factors of a square matrix, computed at the first solve and anew after its values change.
pub struct Direct {
    solver: Owned<ffi::KSP>,
    matrix: Matrix,
}

impl Direct {
    /// A solver for a square matrix by its LU factors; PETSc options with the prefix `direct_` adjust it.
    ///
    /// # Errors
    /// PETSc lacks MUMPS.
    pub fn new(matrix: Matrix) -> Result<Direct> {
        Direct::of(matrix, c"lu")
    }

    /// The same by the Cholesky factors of a symmetric positive matrix.
    ///
    /// # Errors
    /// PETSc lacks MUMPS.
    pub fn positive(matrix: Matrix) -> Result<Direct> {
        petsc!(MatSetOption(matrix.raw(), ffi::MatOption_MAT_SPD, ffi::PetscBool_PETSC_TRUE))?;
        Direct::of(matrix, c"cholesky")
    }

    fn of(matrix: Matrix, factors: &CStr) -> Result<Direct> {
        let session = matrix.session();
        let (mut raw, mut pc) = (null_mut(), null_mut());
        petsc!(KSPCreate(session.communicator(), &mut raw))?;
        let solver = Owned::new(session, raw);
        petsc!(KSPSetOptionsPrefix(raw, c"direct_".as_ptr()))?;
        petsc!(KSPSetOperators(raw, matrix.raw(), matrix.raw()))?;
        petsc!(KSPSetType(raw, c"preonly".as_ptr()))?;
        petsc!(KSPGetPC(raw, &mut pc))?;
        petsc!(PCSetType(pc, factors.as_ptr()))?;
        factor_by_mumps(pc)?;
        petsc!(KSPSetFromOptions(raw))?;
        Ok(Direct { solver, matrix })
    }

    /// Gives the matrix other values in the same places; what is known of its structure is kept.
    ///
    /// # Errors
    /// The places are not the same.
    pub fn replace(&mut self, rows: RowBuilder) -> Result<()> {
        self.matrix.replace(rows)
    }

    /// Solves `A x = rhs` and returns the residual that is left, relative to the right-hand side.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the matrix cannot be factored.
    pub fn solve(&mut self, rhs: &Vector, x: &mut Vector) -> Result<f64> {
        petsc!(KSPSolve(self.solver.raw(), rhs.raw(), x.raw()))?;
        let mut reason = 0;
        petsc!(KSPGetConvergedReason(self.solver.raw(), &mut reason))?;
        if reason < 0 {
            return Err(Error::Diverged(
                "MUMPS cannot factor the matrix: it is singular, or memory is short; a coarser mesh may help".into(),
            ));
        }
        let mut residual = rhs.like()?;
        self.matrix.multiply(x, &mut residual)?;
        residual.add(-1.0, rhs)?;
        let size = rhs.norm()?;
        Ok(if size > 0.0 { residual.norm()? / size } else { 0.0 })
    }
}
