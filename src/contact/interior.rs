//! The interior-point method (Goulart and Chen 2024, Clarabel): a solution to about eight digits.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT},
};

use super::program::Program;

/// What the method found.
pub(super) struct Interior {
    /// The multipliers.
    pub multipliers: Vec<f64>,
    /// Its iterations.
    pub iterations: usize,
    /// Whether it found that no unknowns meet all constraints.
    pub infeasible: bool,
}

/// Solves a program; `None` if the solver does not accept it.
pub(super) fn interior_point(program: &Program) -> Option<Interior> {
    let (unknowns, constraints) = (program.transposed.m, program.transposed.n);
    let metric = CscMatrix::identity(unknowns);
    let mut matrix = CscMatrix::from(program.transposed.t());
    matrix.nzval.iter_mut().for_each(|value| *value = -*value);
    let cones = [SupportedConeT::NonnegativeConeT(constraints)];
    // the active set that starts from this solution does the last digits
    let settings = DefaultSettings { verbose: false, presolve_enable: false, max_threads: 1, ..DefaultSettings::default() };
    let mut solver = DefaultSolver::new(&metric, &vec![0.0; unknowns], &matrix, &program.offsets, &cones, settings).ok()?;
    solver.solve();
    let infeasible = matches!(solver.solution.status, SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible);
    Some(Interior { multipliers: solver.solution.z, iterations: solver.solution.iterations as usize, infeasible })
}
