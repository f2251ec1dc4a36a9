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
    solve_with_equations(program.transposed.clone(), &[], &program.offsets)
}

/// Finds the multipliers of `A x + c >= 0` where `x` is least and meets equations too, `B x = b`; `None` if the solver does not accept it. Columns of
/// `transposed` are first the rows of `B`, then those of `A`.
pub(super) fn solve_with_equations(transposed: CscMatrix<f64>, equations: &[f64], offsets: &[f64]) -> Option<Answer> {
    let unknowns = transposed.m;
    let metric = CscMatrix::identity(unknowns);
    let mut matrix = CscMatrix::from(transposed.t());
    matrix.nzval.iter_mut().for_each(|value| *value = -*value);
    let sides: Vec<f64> = equations.iter().map(|side| -side).chain(offsets.iter().copied()).collect();
    let cones = [SupportedConeT::ZeroConeT(equations.len()), SupportedConeT::NonnegativeConeT(offsets.len())];
    let settings = DefaultSettings {
        verbose: false,
        presolve_enable: false,
        max_threads: 1,
        tol_feas: FEASIBILITY,
        tol_gap_abs: DUALITY_GAP,
        tol_gap_rel: DUALITY_GAP,
        ..DefaultSettings::default()
    };
    let cones = if equations.is_empty() { &cones[1..] } else { &cones[..] };
    let mut solver = DefaultSolver::new(&metric, &vec![0.0; unknowns], &matrix, &sides, cones, settings).ok()?;
    solver.solve();
    if std::env::var("DBG").is_ok() { let i=&solver.info; eprintln!("  {} eq {} ineq {} it {} {:?} pres {:e} dres {:e} gap {:e} {:e}", unknowns, equations.len(), offsets.len(), i.iterations, solver.solution.status, i.res_primal, i.res_dual, i.gap_abs, i.gap_rel); }
    let infeasible = matches!(solver.solution.status, SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible);
    let multipliers = solver.solution.z.split_off(equations.len());
    Some(Answer { multipliers, iterations: solver.solution.iterations as usize, infeasible })
}
