//! `-Lap u = f` in the unit box with `u = 0` on the walls, solved by conjugate gradients with several preconditioners.
//!
//! The unknowns are those of the first velocity component: on grid planes along x, half a cell off the walls along the other axes.
//! Along each axis the eigenvalues of minus the Laplacian are `4/h^2 sin^2(k pi h/2)`, `k` from 1 to `n-1` on grid planes and to `n`
//! between them (`n = 1/h`), so the condition number is known exactly; it tends to `(4/pi^2) (L/h)^2` whatever the dimension.

use std::{f64::consts::PI, time::Instant};

use nalgebra::SVector;
use serde::Serialize;

use super::energy::{History, Inverse, Watched};
use crate::{
    error::{Error, Result},
    geometry::{Axis, Domain},
    grid::{Grid, operators},
    petsc::{
        Amg, AmgSettings, Krylov, KrylovMethod, KrylovSettings, Matrix, Preconditioner, PreconditionerKind, Session, Vector,
        local_heap_bytes,
    },
};

/// Error wanted in the energy norm, over the energy norm of the solution.
pub const WANTED: f64 = 1e-8;

/// Relative residual at which a solve ends: far enough for the error wanted, and for the extreme eigenvalues to have settled.
const RESIDUAL: f64 = 1e-10;

const MOST_ITERATIONS: usize = 100_000;

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

    /// Whether it is multigrid, with iterations that do not feel the grid.
    pub fn multigrid(self) -> bool {
        matches!(self, Method::DefaultAmg | Method::TunedAmg)
    }

    fn set_up(self, matrix: &Matrix, dimension: usize) -> Result<Inverse> {
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

/// One grid, solved with one preconditioner.
#[derive(Debug, Clone, Serialize)]
pub struct Solve {
    /// Dimension of the box.
    pub dimension: usize,
    /// Cells per side, `1/h`.
    pub cells: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Preconditioner.
    pub method: Method,
    /// Smallest eigenvalue of the preconditioned matrix, from the Lanczos matrix of the solve.
    pub smallest: f64,
    /// Largest eigenvalue, likewise.
    pub largest: f64,
    /// Their ratio.
    pub condition: f64,
    /// Iterations until the error in the energy norm is [`WANTED`].
    pub iterations: usize,
    /// Seconds to set the preconditioner up.
    pub setup_seconds: f64,
    /// Seconds of these iterations.
    pub solve_seconds: f64,
    /// Bytes of the preconditioner on all ranks.
    pub bytes: f64,
    /// Bytes of the matrix on all ranks.
    pub matrix_bytes: f64,
    /// Largest part of the Chebyshev bound that the error took up, over all iterations.
    pub bound_taken: f64,
    /// Error in the energy norm before and after each iteration, over that of the solution.
    pub errors: Vec<f64>,
}

/// Extreme eigenvalues of the matrix, in closed form: smallest, largest.
pub fn exact_eigenvalues(dimension: usize, cells: usize) -> (f64, f64) {
    let h = 1.0 / cells as f64;
    let eigenvalue = |k: usize| 4.0 / (h * h) * (k as f64 * PI * h / 2.0).sin().powi(2);
    let others = (dimension - 1) as f64;
    (dimension as f64 * eigenvalue(1), eigenvalue(cells - 1) + others * eigenvalue(cells))
}

/// The bound `2 ((sqrt(kappa) - 1) / (sqrt(kappa) + 1))^k` on the error in the energy norm over the first one.
pub fn chebyshev_bound(condition: f64, iteration: usize) -> f64 {
    let root = condition.max(1.0).sqrt();
    2.0 * ((root - 1.0) / (root + 1.0)).powi(iteration as i32)
}

/// The box with its matrix, its right-hand side and the solution that belongs to it.
pub struct Problem<const D: usize> {
    cells: usize,
    matrix: Matrix,
    matrix_bytes: f64,
    solution: Vector,
    rhs: Vector,
}

impl<const D: usize> Problem<D> {
    /// Assembles it.
    ///
    /// # Errors
    /// The rank count does not fit, or memory is short.
    pub fn new(session: &Session, cells: usize) -> Result<Problem<D>> {
        let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain::<D> { size: SVector::repeat(1.0), axes: [still; D] };
        let grid = Grid::new(&domain, 1.0 / cells as f64, session.world().size(), session.world().rank())?;
        let (matrix, matrix_bytes) = with_bytes(session, || operators::minus_laplacian(session, &grid, 0))?;
        let mut solution = Vector::new(session, grid.local_unknowns(0))?;
        for (value, index) in solution.local_mut()?.iter_mut().zip(grid.block(0).indices()) {
            *value = all_scales(&grid.position(0, operators::signed(index)));
        }
        let mut rhs = solution.like()?;
        matrix.multiply(&solution, &mut rhs)?;
        Ok(Problem { cells, matrix, matrix_bytes, solution, rhs })
    }

    /// Solves it with one preconditioner.
    ///
    /// # Errors
    /// The solver does not converge.
    pub fn solve(&self, method: Method) -> Result<Solve> {
        let session = self.matrix.session();
        let start = Instant::now();
        let (inverse, bytes) = with_bytes(session, || method.set_up(&self.matrix, D))?;
        let setup_seconds = session.world().max(start.elapsed().as_secs_f64());
        let settings = KrylovSettings { method: KrylovMethod::ConjugateGradients, tolerance: RESIDUAL, most_iterations: MOST_ITERATIONS };
        let mut krylov = Krylov::new(session, self.rhs.local()?.len(), c"laplacian_", settings)?;
        krylov.keep_singular_values()?;
        let mut x = self.rhs.like()?;
        let mut system = Watched::new(&self.matrix, inverse);
        krylov.solve(&mut system, (&self.rhs, &mut x), &mut |_, _| {})?;
        let (largest, smallest) = krylov.extreme_singular_values()?;
        let history = system.history(self.energy_of_error(x)?, self.solution.dot(&self.rhs)?);
        let iterations = reached(&history)?;
        let condition = largest / smallest;
        Ok(Solve {
            dimension: D,
            cells: self.cells,
            unknowns: (self.cells - 1) * self.cells.pow(D as u32 - 1),
            method,
            smallest,
            largest,
            condition,
            iterations,
            setup_seconds,
            solve_seconds: session.world().max(history.seconds[iterations]),
            bytes,
            matrix_bytes: self.matrix_bytes,
            bound_taken: bound_taken(&history.errors, condition),
            errors: history.errors,
        })
    }

    /// Squared energy of the error of `x`.
    fn energy_of_error(&self, mut x: Vector) -> Result<f64> {
        x.add(-1.0, &self.solution)?;
        let mut residual = x.like()?;
        self.matrix.multiply(&x, &mut residual)?;
        x.dot(&residual)
    }
}

/// Iterations until the error is as small as wanted.
fn reached(history: &History) -> Result<usize> {
    history.errors.iter().position(|&error| error <= WANTED).ok_or_else(|| {
        let error = history.errors.last().copied().unwrap_or(1.0);
        Error::Diverged(format!("conjugate gradients left an error of {error:.1e} in the energy norm, {WANTED:.0e} is wanted"))
    })
}

fn bound_taken(errors: &[f64], condition: f64) -> f64 {
    let first = errors[0];
    let taken = |(iteration, error): (usize, &f64)| error / first / chebyshev_bound(condition, iteration);
    errors.iter().enumerate().map(taken).fold(0.0, f64::max)
}

/// Makes something, and tells the bytes that it keeps on all ranks.
fn with_bytes<T>(session: &Session, make: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    let before = local_heap_bytes();
    let made = make()?;
    let mut bytes = [local_heap_bytes() - before];
    session.world().sum(&mut bytes);
    Ok((made, bytes[0].max(0.0)))
}

/// Waves and a step: energy at all scales, and in no symmetric way, so that no eigenvector is missed.
fn all_scales<const D: usize>(point: &SVector<f64, D>) -> f64 {
    let step = if (point[0] - 0.3).abs() < 0.1 { 1.0 } else { 0.0 };
    let phase: f64 = point.iter().zip([7.0, 5.0, 3.0]).map(|(coordinate, wave)| wave * coordinate).sum();
    phase.sin() + step
}
