//! The interior-point method (Goulart and Chen 2024, Clarabel): a solution to eight digits or more.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT},
};

use super::program::{Answer, Program};

/// Relative to the largest gap, which may be far larger than the violations that matter.
const FEASIBILITY: f64 = 1e-9;
/// Small, so that forces on open gaps fade; feasibility follows by itself and would, if small, stop progress.
const DUALITY_GAP: f64 = 1e-12;

/// Solves a program; `None` if the solver does not accept it.
pub(super) fn solve_by_clarabel(program: &Program) -> Option<Answer> {
    let unknowns = program.transposed.m;
    let metric = CscMatrix::identity(unknowns);
    let mut matrix = CscMatrix::from(program.transposed.t());
    matrix.nzval.iter_mut().for_each(|value| *value = -*value);
    let cones = [SupportedConeT::NonnegativeConeT(program.offsets.len())];
    let settings = DefaultSettings {
        verbose: false,
        presolve_enable: false,
        max_threads: 1,
        tol_feas: FEASIBILITY,
        tol_gap_abs: DUALITY_GAP,
        tol_gap_rel: DUALITY_GAP,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(&metric, &vec![0.0; unknowns], &matrix, &program.offsets, &cones, settings).ok()?;
    solver.solve();
    let infeasible = matches!(solver.solution.status, SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible);
    Some(Answer { multipliers: solver.solution.z, iterations: solver.solution.iterations as usize, infeasible })
}
