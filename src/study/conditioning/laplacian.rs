//! `-Lap u = f` in the unit box with `u = 0` on the walls, solved by conjugate gradients with several preconditioners.
//!
//! The unknowns are those of the first velocity component: on grid planes along x, half a cell off the walls along the other axes.
//! Along each axis the eigenvalues of minus the Laplacian are `4/h^2 sin^2(k pi h/2)`, `k` from 1 to `n-1` on grid planes and to `n`
//! between them (`n = 1/h`), so the condition number is known exactly; it tends to `(4/pi^2) (L/h)^2` whatever the dimension.

use std::{f64::consts::PI, time::Instant};

use nalgebra::SVector;
use serde::Serialize;

use super::{
    energy::{EnergyMonitor, History},
    preconditioning::Preconditioning,
};
use crate::{
    error::{Error, Result},
    geometry::{Axis, Domain},
    grid::{Grid, operators},
    petsc::{Krylov, KrylovMethod, KrylovSettings, Matrix, Session, Vector, local_heap_bytes},
};

/// Error wanted in the energy norm, over the energy norm of the solution.
pub const WANTED: f64 = 1e-8;

/// Relative residual at which a solve ends: far enough for the error wanted, and for the extreme eigenvalues to have settled.
const RESIDUAL: f64 = 1e-10;

const MOST_ITERATIONS: usize = 100_000;

/// One grid, solved with one preconditioner.
#[derive(Debug, Clone, Serialize)]
pub struct LaplacianSolve {
    /// Dimension of the box.
    pub dimension: usize,
    /// Cells per side, `1/h`.
    pub cells: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Preconditioner.
    pub method: Preconditioning,
    /// Smallest eigenvalue of the preconditioned matrix, from the Lanczos matrix of the solve.
    pub smallest: f64,
    /// Largest eigenvalue, likewise.
    pub largest: f64,
    /// Their ratio.
    pub condition: f64,
    /// The same in closed form, where there is no preconditioner.
    pub exact_condition: Option<f64>,
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
    /// Iterations that the Chebyshev bound promises to be enough.
    pub promised_iterations: usize,
    /// Largest part of the Chebyshev bound that the error took up, over all iterations.
    pub bound_taken: f64,
    /// Error in the energy norm before and after each iteration, over that of the solution.
    pub errors: Vec<f64>,
}

/// The condition number of the matrix in closed form.
pub fn exact_condition(dimension: usize, cells: usize) -> f64 {
    let part = |k: usize| (k as f64 * PI / (2.0 * cells as f64)).sin().powi(2);
    (part(cells - 1) + (dimension - 1) as f64) / (dimension as f64 * part(1))
}

/// The bound `2 ((sqrt(kappa) - 1) / (sqrt(kappa) + 1))^k` on the error in the energy norm over the first one.
fn chebyshev_bound(condition: f64, iteration: usize) -> f64 {
    let root = condition.max(1.0).sqrt();
    2.0 * ((root - 1.0) / (root + 1.0)).powi(iteration as i32)
}

/// Iterations after which the bound is below [`WANTED`].
fn promised_iterations(condition: f64) -> usize {
    let rate = chebyshev_bound(condition, 1) / 2.0;
    ((WANTED / 2.0).ln() / rate.ln()).ceil().max(1.0) as usize
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
    pub fn solve(&self, method: Preconditioning) -> Result<LaplacianSolve> {
        let session = self.matrix.session();
        let start = Instant::now();
        let (inverse, bytes) = with_bytes(session, || method.set_up(&self.matrix, D))?;
        let setup_seconds = session.world().max(start.elapsed().as_secs_f64());
        let settings = KrylovSettings { method: KrylovMethod::ConjugateGradients, tolerance: RESIDUAL, most_iterations: MOST_ITERATIONS };
        let mut krylov = Krylov::new(session, self.rhs.local()?.len(), c"laplacian_", settings)?;
        krylov.keep_singular_values()?;
        let mut x = self.rhs.like()?;
        let mut system = EnergyMonitor::new(&self.matrix, inverse);
        krylov.solve(&mut system, &self.rhs, &mut x, &mut |_, _| {})?;
        let (largest, smallest) = krylov.extreme_singular_values()?;
        let history = system.history(self.energy_of_error(x)?, self.solution.dot(&self.rhs)?);
        let iterations = reached(&history)?;
        let condition = largest / smallest;
        let exact_condition = (method == Preconditioning::None).then(|| exact_condition(D, self.cells));
        let bounding = exact_condition.unwrap_or(condition);
        Ok(LaplacianSolve {
            dimension: D,
            cells: self.cells,
            unknowns: (self.cells - 1) * self.cells.pow(D as u32 - 1),
            method,
            smallest,
            largest,
            condition,
            exact_condition,
            iterations,
            setup_seconds,
            solve_seconds: session.world().max(history.seconds[iterations]),
            bytes,
            matrix_bytes: self.matrix_bytes,
            promised_iterations: promised_iterations(bounding),
            bound_taken: bound_taken(&history.errors, bounding),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_condition_is_that_of_a_small_matrix() {
        // n = 2 in 2D: two unknowns on the middle plane, 4 * [[5, -1], [-1, 5]], eigenvalues 24 and 16
        assert!((exact_condition(2, 2) - 1.5).abs() < 1e-14);
        assert!((exact_condition(3, 512) * (PI / 1024.0).powi(2) - 1.0).abs() < 1e-5, "it tends to (4/pi^2) n^2");
    }

    #[test]
    fn the_bound_is_met_after_the_iterations_that_it_promises() {
        for condition in [1.01, 3.0, 1e5] {
            let promised = promised_iterations(condition);
            assert!(chebyshev_bound(condition, promised) <= WANTED * (1.0 + 1e-9));
            assert!(promised == 1 || chebyshev_bound(condition, promised - 1) > WANTED);
        }
        assert_eq!(promised_iterations(1.0), 1);
    }
}
