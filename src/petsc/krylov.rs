//! Krylov solvers for operators and preconditioners written in Rust.

use std::{
    cell::Cell,
    ffi::{CStr, c_void},
    ptr::null_mut,
    time::Instant,
};

use super::{
    DEFAULT, Session, System, Vector,
    call::guard,
    ffi, index,
    options::number,
    owned::Owned,
    petsc,
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
    /// The same with a preconditioner that may differ from iteration to iteration, which takes twice the vectors.
    FlexibleGmres {
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

/// Loosest tolerance that an option of PETSc's may ask for: what a scene may, too.
const LOOSEST: f64 = 0.1;

/// What may help where a solve does not converge.
const REMEDY: &str = "fewer modes, a finer grid or a looser method.tolerance may help";

/// The true residual over the tolerance that a solve may end with where rounding leaves no less, and over the solver's estimate up to which
/// the two differ by no more than rounding.
const SLACK: f64 = 2.0;

/// Times that a solve goes on from its true residual, if that is above the tolerance.
const MOST_RESTARTS: usize = 3;

/// Part of the tolerance that a solve aims at when it goes on, so that what led it astray does not leave it above again.
const AIM: f64 = 0.5;

/// Part of the true residual above which such a solve has left it where it was.
const STAGNATION: f64 = 0.9;

/// What a solve cost and reached.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Iterations.
    pub iterations: usize,
    /// Last residual norm, relative to that of the right-hand side, or to what rounding makes of the scene where that is more.
    pub residual: f64,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// A Krylov solver for vectors of one shape; its work vectors are kept from solve to solve.
///
/// A solve has converged once its true residual, not the solver's estimate, is within the tolerance: rounding that leads the estimate
/// astray, a Krylov space that is exhausted, or an option of PETSc's does not make an answer of what is none. A solve that ends above
/// it goes on from the true residual of what it has found; where that does not fall, rounding leaves no less, and up to twice the tolerance will do.
pub struct Krylov {
    solver: Owned<ffi::KSP>,
    matrix: Owned<ffi::Mat>,
    settings: KrylovSettings,
    /// Relative and absolute tolerance among PETSc's options, which no others override.
    by_option: [bool; 2],
    remedy: &'static str,
    /// Where the monitor finds what watches the solve under way.
    watch: Box<Cell<*mut c_void>>,
}

/// What the monitor callback needs during one solve.
struct Watch<'a> {
    scale: f64,
    before: usize,
    monitor: &'a mut dyn FnMut(usize, f64),
}

/// What a solve is measured by.
#[derive(Clone, Copy)]
struct SolveMeasure {
    /// Norm of a residual that is all rounding.
    rounding: f64,
    /// Norm over which residuals are told.
    size: f64,
    /// When it began.
    start: Instant,
}

/// What a solve has come to.
enum Verdict {
    /// The first guess is worse than none.
    BadStart,
    /// The residual is small enough.
    Converged,
    /// Going on would not lower the residual.
    Stagnated,
    /// The residual may fall further.
    Improved,
}

impl Krylov {
    /// A solver for vectors with `local` entries on this rank; PETSc options with the given prefix override `settings`.
    ///
    /// # Errors
    /// An option asks for a tolerance that is none.
    pub fn new(session: &Session, local: usize, prefix: &CStr, settings: KrylovSettings) -> Result<Krylov> {
        let tolerance = tolerance_option(prefix)?;
        let by_option = [tolerance.is_some(), number(prefix, c"-ksp_atol")?.is_some()];
        let settings = KrylovSettings { tolerance: tolerance.unwrap_or(settings.tolerance), ..settings };
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
        let watch = Box::new(Cell::new(null_mut()));
        petsc!(KSPMonitorSet(raw, Some(monitor), (&raw const *watch).cast_mut().cast(), None))?;
        petsc!(KSPSetFromOptions(raw))?;
        Ok(Krylov { solver, matrix, settings, by_option, remedy: REMEDY, watch })
    }

    /// The same solver, with other advice where it does not converge.
    pub fn with_remedy(self, remedy: &'static str) -> Krylov {
        Krylov { remedy, ..self }
    }

    /// Makes further solves end at another residual, unless PETSc's options say at which.
    pub fn set_tolerance(&mut self, tolerance: f64) {
        if !self.by_option[0] {
            self.settings.tolerance = tolerance;
        }
    }

    /// Solves `A x = rhs` starting from `x`; `monitor` is told each iteration and its relative residual. The system is applied to `x` last.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the true residual does not reach the tolerance, with the iterations made, the residual reached and,
    /// where going on from it did not lower it, that it stagnates.
    pub fn solve(&mut self, system: &mut dyn System, rhs: &Vector, x: &mut Vector, monitor: &mut dyn FnMut(usize, f64)) -> Result<Report> {
        self.solve_above(0.0, system, rhs, x, monitor)
    }

    /// As [`solve`](Self::solve), where a residual of the norm `rounding` is what rounding makes of a right-hand side that should be zero.
    ///
    /// # Errors
    /// The same.
    pub fn solve_above(
        &mut self,
        rounding: f64,
        system: &mut dyn System,
        rhs: &Vector,
        x: &mut Vector,
        monitor: &mut dyn FnMut(usize, f64),
    ) -> Result<Report> {
        let start = Instant::now();
        let norm = rhs.norm()?;
        let size = norm.max(rounding / self.settings.tolerance);
        if norm <= rounding {
            x.fill(0.0)?;
            system.apply(x, &mut rhs.like()?)?;
            return Ok(Report { residual: if norm > 0.0 { norm / size } else { 0.0 }, ..Report::default() });
        }
        self.solve_with_restarts(SolveMeasure { rounding, size, start }, system, rhs, x, monitor)
    }

    /// Solves, and again from what was reached, until the true residual, over its measure, is small enough or falls no more.
    fn solve_with_restarts(
        &mut self,
        measure: SolveMeasure,
        system: &mut dyn System,
        rhs: &Vector,
        x: &mut Vector,
        monitor: &mut dyn FnMut(usize, f64),
    ) -> Result<Report> {
        let (mut residual, size) = (rhs.like()?, measure.size);
        let (mut report, mut last, mut restarts) = (Report::default(), f64::INFINITY, 0);
        let mut passable: Option<(Vector, f64)> = None;
        loop {
            self.set_stopping_rule(measure.rounding, if restarts == 0 { 1.0 } else { AIM })?;
            self.call(system, rhs, x, Watch { scale: 1.0 / size, before: report.iterations, monitor })?;
            let truth = true_residual(system, rhs, x, &mut residual)? / size;
            report = self.outcome(report.iterations, measure, truth)?;
            match self.verdict(truth, last, restarts)? {
                Verdict::BadStart => {
                    // where all comes to rest, what is extrapolated is a worse start than none
                    x.fill(0.0)?;
                    restarts += 1;
                    continue;
                }
                Verdict::Converged => return Ok(report),
                Verdict::Stagnated => {
                    let Some((kept, _)) = passable else { return Err(self.diverged(report, last)?) };
                    // going on made it worse
                    x.copy_from(&kept)?;
                    let residual = true_residual(system, rhs, x, &mut residual)? / size;
                    return Ok(Report { residual, ..report });
                }
                Verdict::Improved => {}
            }
            if truth <= SLACK * self.settings.tolerance && passable.as_ref().is_none_or(|(_, kept)| truth < *kept) {
                let kept = x.copied()?;
                passable = Some((kept, truth));
            }
            (last, restarts) = (truth, restarts + 1);
        }
    }

    /// What a solve has come to after so many restarts, from a true residual before it and one after it.
    fn verdict(&self, truth: f64, last: f64, restarts: usize) -> Result<Verdict> {
        let reason = self.reason()?;
        if restarts == 0 && reason == ffi::KSPConvergedReason_KSP_DIVERGED_DTOL {
            return Ok(Verdict::BadStart);
        }
        // a space that is exhausted, or a recurrence that rounding has led astray, may serve again from here
        let over = truth.is_nan() || reason < 0 && reason != ffi::KSPConvergedReason_KSP_DIVERGED_BREAKDOWN;
        let over = over || restarts == MOST_RESTARTS || truth > STAGNATION * last;
        let enough = if over { SLACK } else { 1.0 } * self.settings.tolerance;
        Ok(match over {
            _ if truth <= enough && reason != ffi::KSPConvergedReason_KSP_DIVERGED_ITS => Verdict::Converged,
            true => Verdict::Stagnated,
            false => Verdict::Improved,
        })
    }

    fn call(&self, system: &mut dyn System, rhs: &Vector, x: &mut Vector, watch: Watch) -> Result<()> {
        let mut context = Context { session: self.solver.session().clone(), system };
        let (mut watch, mut pc) = (watch, null_mut());
        let solver = self.solver.raw();
        petsc!(KSPGetPC(solver, &mut pc))?;
        petsc!(MatShellSetContext(self.matrix.raw(), (&raw mut context).cast()))?;
        petsc!(PCShellSetContext(pc, (&raw mut context).cast()))?;
        self.watch.set((&raw mut watch).cast());
        let outcome = petsc!(KSPSolve(solver, rhs.raw(), x.raw()));
        // what these point to lives on this stack frame: no pointer to it may outlast it
        self.watch.set(null_mut());
        petsc!(MatShellSetContext(self.matrix.raw(), null_mut()))?;
        petsc!(PCShellSetContext(pc, null_mut()))?;
        outcome
    }

    /// Makes the next call end at this part of the tolerance, or of the norm that is rounding.
    fn set_stopping_rule(&self, rounding: f64, part: f64) -> Result<()> {
        let kept = f64::from(ffi::PETSC_DEFAULT);
        let absolute = if self.by_option[1] { kept } else { part * rounding };
        petsc!(KSPSetTolerances(self.solver.raw(), part * self.settings.tolerance, absolute, kept, DEFAULT))
    }

    fn reason(&self) -> Result<ffi::KSPConvergedReason> {
        let mut reason = 0;
        petsc!(KSPGetConvergedReason(self.solver.raw(), &mut reason))?;
        Ok(reason)
    }

    /// What a call came to, after so many iterations before it: the residual is the solver's, unless that is not the true one or the true one is
    /// above the tolerance.
    fn outcome(&self, before: usize, measure: SolveMeasure, truth: f64) -> Result<Report> {
        let (mut iterations, mut residual) = (0, 0.0);
        petsc!(KSPGetIterationNumber(self.solver.raw(), &mut iterations))?;
        petsc!(KSPGetResidualNorm(self.solver.raw(), &mut residual))?;
        let estimate = residual / measure.size;
        let residual = if truth <= self.settings.tolerance.min(SLACK * estimate) { estimate } else { truth };
        Ok(Report { iterations: before + iterations as usize, residual, seconds: measure.start.elapsed().as_secs_f64() })
    }

    /// The error of a solve that came to this, after going on from a true residual of `last` (infinite if it did not go on).
    fn diverged(&self, report: Report, last: f64) -> Result<Error> {
        let mut text = std::ptr::null();
        petsc!(KSPGetConvergedReasonString(self.solver.raw(), &mut text))?;
        let reason = unsafe { CStr::from_ptr(text) }.to_string_lossy();
        let account = match self.reason()? > 0 {
            true if last.is_finite() => format!(" by its own account, and stagnates: it went on from a true residual of {last:.1e}"),
            true => " by its own account".to_owned(),
            false => String::new(),
        };
        Ok(Error::Diverged(format!(
            "the linear solver stopped after {} iterations at a relative residual of {:.1e}, tolerance {:.1e} ({reason}{account}); {}",
            report.iterations, report.residual, self.settings.tolerance, self.remedy
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
        KrylovMethod::Gmres { restart } | KrylovMethod::FlexibleGmres { restart } => {
            let kind = if let KrylovMethod::Gmres { .. } = settings.method { c"gmres" } else { c"fgmres" };
            petsc!(KSPSetType(solver, kind.as_ptr()))?;
            petsc!(KSPGMRESSetRestart(solver, index(restart)))?;
            // without it dense fixed arrays lose orthogonality, and the residual stalls
            petsc!(KSPGMRESSetCGSRefinementType(solver, ffi::KSPGMRESCGSRefinementType_KSP_GMRES_CGS_REFINE_IFNEEDED))?;
            petsc!(KSPSetPCSide(solver, ffi::PCSide_PC_RIGHT))?;
        }
    }
    petsc!(KSPSetNormType(solver, norm))?;
    petsc!(KSPSetInitialGuessNonzero(solver, ffi::PetscBool_PETSC_TRUE))?;
    let unused = f64::from(ffi::PETSC_DEFAULT);
    petsc!(KSPSetTolerances(solver, settings.tolerance, 0.0, unused, index(settings.most_iterations)))
}

/// The relative tolerance that PETSc's options ask for, if they do.
fn tolerance_option(prefix: &CStr) -> Result<Option<f64>> {
    let tolerance = number(prefix, c"-ksp_rtol")?;
    match tolerance.filter(|tolerance| !(*tolerance > 0.0 && *tolerance <= LOOSEST)) {
        None => Ok(tolerance),
        Some(wrong) => Err(Error::refused(format!(
            "the PETSc option -{}ksp_rtol = {wrong} must be above 0 and at most {LOOSEST}, as method.tolerance; lower it or remove it",
            prefix.to_string_lossy()
        ))),
    }
}

/// The norm of what `x` leaves of a right-hand side.
fn true_residual(system: &mut dyn System, rhs: &Vector, x: &Vector, residual: &mut Vector) -> Result<f64> {
    system.apply(x, residual)?;
    residual.add(-1.0, rhs)?;
    residual.norm()
}

extern "C" fn monitor(_: ffi::KSP, iteration: ffi::PetscInt, residual: f64, context: *mut c_void) -> ffi::PetscErrorCode {
    guard(|| {
        let watch = unsafe { &*context.cast::<Cell<*mut c_void>>() }.get().cast::<Watch>();
        if let Some(watch) = unsafe { watch.as_mut() } {
            (watch.monitor)(watch.before + iteration as usize, residual * watch.scale);
        }
        Ok(())
    })
}
