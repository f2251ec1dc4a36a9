//! Solves with sparse matrices, most of them symmetric, by their factors or to a loose tolerance.

use std::ptr::null_mut;

use super::{
    DEFAULT, Matrix, RowBuilder, Session, Vector, direct::factor_by_mumps, ffi, options::insert_unless_given, owned::Owned, petsc,
};
use crate::error::{Error, Result};

/// How a sparse matrix is solved with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SparseMethod {
    /// By factors of a positive matrix: CHOLMOD's on one rank, or else MUMPS's.
    Positive,
    /// By MUMPS's factors of a matrix that is positive on some unknowns and negative on the others.
    Quasidefinite,
    /// By conjugate gradients to a loose tolerance, for a positive matrix whose factors would take too much memory and time.
    Iterated,
    /// By MUMPS's factors of a matrix that is not symmetric, as that of contacts which slip.
    Unsymmetric,
    /// By stabilised biconjugate gradients to a loose tolerance, for such a matrix whose factors would take too much.
    UnsymmetricIterated,
}

/// Residual at which iterations end, over the right-hand side.
const LOOSE: f64 = 1e-2;

/// A sparse matrix to solve with, which all ranks share.
pub struct SparseSolver {
    solver: Owned<ffi::KSP>,
    _matrix: Matrix,
}

impl SparseMethod {
    /// What PETSc is told of the matrix.
    fn symmetry(self) -> Option<ffi::MatOption> {
        match self {
            SparseMethod::Quasidefinite => Some(ffi::MatOption_MAT_SYMMETRIC),
            SparseMethod::Positive | SparseMethod::Iterated => Some(ffi::MatOption_MAT_SPD),
            SparseMethod::Unsymmetric | SparseMethod::UnsymmetricIterated => None,
        }
    }
}

impl SparseSolver {
    /// Sets up solves with the matrix of this rank's rows, of which there are `local`; PETSc options with the prefix `network_` adjust it.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the matrix has no such factors.
    pub fn new(session: &Session, local: usize, rows: RowBuilder, method: SparseMethod) -> Result<SparseSolver> {
        let matrix = Matrix::from_rows(session, local, rows)?;
        if let Some(kind) = method.symmetry() {
            petsc!(MatSetOption(matrix.raw(), kind, ffi::PetscBool_PETSC_TRUE))?;
        }
        let (mut raw, mut pc) = (null_mut(), null_mut());
        petsc!(KSPCreate(session.communicator(), &mut raw))?;
        let solver = Owned::new(session, raw);
        petsc!(KSPSetOptionsPrefix(raw, c"network_".as_ptr()))?;
        petsc!(KSPSetOperators(raw, matrix.raw(), matrix.raw()))?;
        petsc!(KSPGetPC(raw, &mut pc))?;
        if matches!(method, SparseMethod::Iterated | SparseMethod::UnsymmetricIterated) {
            let kept = f64::from(ffi::PETSC_DEFAULT);
            let (krylov, inner) = if method == SparseMethod::Iterated { (c"cg", "icc") } else { (c"bcgs", "ilu") };
            petsc!(KSPSetType(raw, krylov.as_ptr()))?;
            petsc!(KSPSetTolerances(raw, LOOSE, kept, kept, DEFAULT))?;
            petsc!(PCSetType(pc, c"bjacobi".as_ptr()))?;
            insert_unless_given("-network_sub_pc_type", inner)?;
        } else {
            petsc!(KSPSetType(raw, c"preonly".as_ptr()))?;
            let factors = if method == SparseMethod::Unsymmetric { c"lu" } else { c"cholesky" };
            petsc!(PCSetType(pc, factors.as_ptr()))?;
            if method == SparseMethod::Positive && session.world().size() == 1 {
                petsc!(PCFactorSetMatSolverType(pc, c"cholmod".as_ptr()))?;
            } else {
                factor_by_mumps(pc)?;
            }
        }
        petsc!(KSPSetFromOptions(raw))?;
        petsc!(KSPSetUp(raw))?;
        let mut reason = ffi::PCFailedReason_PC_NOERROR;
        petsc!(PCGetFailedReason(pc, &mut reason))?;
        if reason != ffi::PCFailedReason_PC_NOERROR {
            return Err(Error::Diverged("the resistances of contacts and lubrication films cannot be factored".into()));
        }
        Ok(SparseSolver { solver, _matrix: matrix })
    }

    /// Solves `A x = rhs`.
    pub fn solve(&mut self, rhs: &Vector, x: &mut Vector) -> Result<()> {
        petsc!(KSPSolve(self.solver.raw(), rhs.raw(), x.raw()))
    }
}
