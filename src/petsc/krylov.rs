//! Krylov solvers for operators and preconditioners written in Rust.

use std::{
    ffi::{CStr, c_void},
    ptr::null_mut,
    time::Instant,
};

use super::{
    Session, System, Vector, ffi, index,
    owned::Owned,
    petsc,
    session::guard,
    shell::{Context, apply_preconditioner, shell_matrix},
};
use crate::error::{Error, Result};

/// Which Krylov method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KrylovMethod {
    /// Conjugate gradients (symmetric positive operators and preconditioners).
    ConjugateGradients,
    /// MINRES for symmetric indefinite operators, without a preconditioner.
    MinimalResidual,
    /// GMRES, preconditioned from the right: the residual it watches is the true one.
    Gmres {
        /// Vectors kept before a restart.
        restart: usize,
    },
}

/// Method and stopping rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KrylovSettings {
    /// Method.
    pub method: KrylovMethod,
    /// Residual wanted, relative to the right-hand side.
    pub tolerance: f64,
    /// Iterations allowed.
    pub most_iterations: usize,
}

/// What a solve cost and reached.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Iterations.
    pub iterations: usize,
    /// Last residual norm, relative to that of the right-hand side.
    pub residual: f64,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// A Krylov solver for vectors of one shape; its work vectors are kept from solve to solve.
pub struct Krylov {
    solver: Owned<ffi::KSP>,
    matrix: Owned<ffi::Mat>,
    settings: KrylovSettings,
}

/// What the monitor callback needs during one solve.
struct Watch<'a> {
    scale: f64,
    seen: &'a mut dyn FnMut(usize, f64),
}

impl Krylov {
    /// A solver for vectors with `local` entries on this rank; PETSc options with the given prefix override `settings`.
    pub fn new(session: &Session, local: usize, prefix: &CStr, settings: KrylovSettings) -> Result<Krylov> {
        let matrix = shell_matrix(session, index(local))?;
        let mut raw = null_mut();
        petsc!(KSPCreate(session.communicator(), &mut raw))?;
        let solver = Owned::new(session, raw);
        petsc!(KSPSetOptionsPrefix(raw, prefix.as_ptr()))?;
        petsc!(KSPSetOperators(raw, matrix.raw(), matrix.raw()))?;
        set_method(raw, settings)?;
        let mut pc = null_mut();
        petsc!(KSPGetPC(raw, &mut pc))?;
        petsc!(PCSetType(pc, c"shell".as_ptr()))?;
        petsc!(PCShellSetApply(pc, Some(apply_preconditioner)))?;
        petsc!(KSPSetFromOptions(raw))?;
        Ok(Krylov { solver, matrix, settings })
    }

    /// Makes further solves end at another residual.
    pub fn set_tolerance(&mut self, tolerance: f64) -> Result<()> {
        if tolerance == self.settings.tolerance {
            return Ok(());
        }
        self.settings.tolerance = tolerance;
        set_tolerances(self.solver.raw(), self.settings)
    }

    /// Solves `A x = rhs` starting from `x`; `seen` is told each iteration and its relative residual.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the tolerance is not reached, with the iterations made and the residual reached.
    pub fn solve(&mut self, system: &mut dyn System, (rhs, x): (&Vector, &mut Vector), seen: &mut dyn FnMut(usize, f64)) -> Result<Report> {
        let start = Instant::now();
        let size = rhs.norm()?;
        if size == 0.0 {
            x.fill(0.0)?;
            return Ok(Report::default());
        }
        self.call(system, (rhs, x), Watch { scale: 1.0 / size, seen })?;
        self.outcome(size, start)
    }

    fn call(&self, system: &mut dyn System, (rhs, x): (&Vector, &mut Vector), watch: Watch) -> Result<()> {
        let mut context = Context { session: self.solver.session().clone(), system };
        let (mut watch, mut pc) = (watch, null_mut());
        let solver = self.solver.raw();
        petsc!(KSPGetPC(solver, &mut pc))?;
        petsc!(MatShellSetContext(self.matrix.raw(), (&raw mut context).cast()))?;
        petsc!(PCShellSetContext(pc, (&raw mut context).cast()))?;
        petsc!(KSPMonitorSet(solver, Some(monitor), (&raw mut watch).cast(), None))?;
        let outcome = petsc!(KSPSolve(solver, rhs.raw(), x.raw()));
        // the context lives on this stack frame: no pointer to it may outlast it
        petsc!(MatShellSetContext(self.matrix.raw(), null_mut()))?;
        petsc!(PCShellSetContext(pc, null_mut()))?;
        petsc!(KSPMonitorCancel(solver))?;
        outcome
    }

    fn outcome(&self, size: f64, start: Instant) -> Result<Report> {
        let (mut reason, mut iterations, mut residual) = (0, 0, 0.0);
        petsc!(KSPGetConvergedReason(self.solver.raw(), &mut reason))?;
        petsc!(KSPGetIterationNumber(self.solver.raw(), &mut iterations))?;
        petsc!(KSPGetResidualNorm(self.solver.raw(), &mut residual))?;
        let report = Report { iterations: iterations as usize, residual: residual / size, seconds: start.elapsed().as_secs_f64() };
        if reason > 0 { Ok(report) } else { Err(self.diverged(report)?) }
    }

    fn diverged(&self, report: Report) -> Result<Error> {
        let mut text = std::ptr::null();
        petsc!(KSPGetConvergedReasonString(self.solver.raw(), &mut text))?;
        let reason = unsafe { CStr::from_ptr(text) }.to_string_lossy();
        Ok(Error::Diverged(format!(
            "the linear solver stopped after {} iterations at a relative residual of {:.1e}, tolerance {:.1e} ({reason}); \
             fewer modes, a finer grid or a looser method.tolerance may help",
            report.iterations, report.residual, self.settings.tolerance
        )))
    }

    /// Makes further solves keep what [`extreme_singular_values`](Self::extreme_singular_values) needs (not with MINRES).
    pub fn keep_singular_values(&mut self) -> Result<()> {
        petsc!(KSPSetComputeSingularValues(self.solver.raw(), ffi::PetscBool_PETSC_TRUE))
    }

    /// Extreme singular values of the preconditioned operator as estimated during the last solve (largest, smallest).
    pub fn extreme_singular_values(&self) -> Result<(f64, f64)> {
        let (mut largest, mut smallest) = (0.0, 0.0);
        petsc!(KSPComputeExtremeSingularValues(self.solver.raw(), &mut largest, &mut smallest))?;
        Ok((largest, smallest))
    }
}

fn set_method(solver: ffi::KSP, settings: KrylovSettings) -> Result<()> {
    let mut norm = ffi::KSPNormType_KSP_NORM_UNPRECONDITIONED;
    match settings.method {
        KrylovMethod::ConjugateGradients => petsc!(KSPSetType(solver, c"cg".as_ptr()))?,
        KrylovMethod::MinimalResidual => {
            petsc!(KSPSetType(solver, c"minres".as_ptr()))?;
            norm = ffi::KSPNormType_KSP_NORM_PRECONDITIONED;
        }
        KrylovMethod::Gmres { restart } => {
            petsc!(KSPSetType(solver, c"gmres".as_ptr()))?;
            petsc!(KSPGMRESSetRestart(solver, index(restart)))?;
            // without it dense fixed arrays lose orthogonality, and the residual stalls
            petsc!(KSPGMRESSetCGSRefinementType(solver, ffi::KSPGMRESCGSRefinementType_KSP_GMRES_CGS_REFINE_IFNEEDED))?;
            petsc!(KSPSetPCSide(solver, ffi::PCSide_PC_RIGHT))?;
        }
    }
    petsc!(KSPSetNormType(solver, norm))?;
    petsc!(KSPSetInitialGuessNonzero(solver, ffi::PetscBool_PETSC_TRUE))?;
    set_tolerances(solver, settings)
}

fn set_tolerances(solver: ffi::KSP, settings: KrylovSettings) -> Result<()> {
    let unused = f64::from(ffi::PETSC_DEFAULT);
    petsc!(KSPSetTolerances(solver, settings.tolerance, 0.0, unused, index(settings.most_iterations)))
}

extern "C" fn monitor(_: ffi::KSP, iteration: i32, residual: f64, context: *mut c_void) -> ffi::PetscErrorCode {
    guard(|| {
        let watch = unsafe { &mut *context.cast::<Watch>() };
        (watch.seen)(iteration as usize, residual * watch.scale);
        Ok(())
    })
}
