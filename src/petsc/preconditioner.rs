//! PETSc's own approximate inverses of a symmetric positive matrix, for comparison with ours.

use std::ptr::null_mut;

use super::{Matrix, Vector, ffi, options::insert_unless_given, owned::Owned, petsc};
use crate::error::Result;

/// Which approximate inverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PreconditionerKind {
    /// The inverse of the diagonal.
    Jacobi,
    /// Cholesky factors without fill; each rank factors its own diagonal block.
    IncompleteCholesky,
    /// One V-cycle of hypre's BoomerAMG with the parameters that PETSc gives it.
    BoomerAmg,
}

/// An approximate inverse, set up once; PETSc options with the prefixes `jacobi_`, `cholesky_` and `boomeramg_` adjust it.
pub struct Preconditioner {
    owned: Owned<ffi::PC>,
}

impl Preconditioner {
    /// Sets one up for `matrix`.
    ///
    /// # Errors
    /// The matrix has no such factors, or memory is short.
    pub fn new(matrix: &Matrix, kind: PreconditionerKind) -> Result<Preconditioner> {
        let session = matrix.session();
        let (prefix, name) = match kind {
            PreconditionerKind::Jacobi => (c"jacobi_", c"jacobi"),
            PreconditionerKind::IncompleteCholesky => (c"cholesky_", c"bjacobi"),
            PreconditionerKind::BoomerAmg => (c"boomeramg_", c"hypre"),
        };
        let mut raw = null_mut();
        petsc!(PCCreate(session.communicator(), &mut raw))?;
        let owned = Owned::new(session, raw);
        petsc!(PCSetOptionsPrefix(raw, prefix.as_ptr()))?;
        petsc!(PCSetType(raw, name.as_ptr()))?;
        petsc!(PCSetOperators(raw, matrix.raw(), matrix.raw()))?;
        match kind {
            PreconditionerKind::Jacobi => {}
            PreconditionerKind::IncompleteCholesky => insert_unless_given("-cholesky_sub_pc_type", "icc")?,
            PreconditionerKind::BoomerAmg => petsc!(PCHYPRESetType(raw, c"boomeramg".as_ptr()))?,
        }
        petsc!(PCSetFromOptions(raw))?;
        petsc!(PCSetUp(raw))?;
        petsc!(PCSetUpOnBlocks(raw))?;
        Ok(Preconditioner { owned })
    }

    /// `output = P input`.
    pub fn apply(&self, input: &Vector, output: &mut Vector) -> Result<()> {
        petsc!(PCApply(self.owned.raw(), input.raw(), output.raw()))
    }
}
