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

/// What the method found.
pub struct GeneralAnswer {
    /// Multipliers and slacks of the inequalities.
    pub multipliers: Vec<f64>,
    pub slacks: Vec<f64>,
    pub iterations: usize,
    pub infeasible: bool,
    /// Whether it is a solution to what was asked for.
    pub solved: bool,
}

/// Solves a program; `None` if the solver does not accept it.
pub fn solve_by_clarabel(program: &Program) -> Option<Answer> {
    let GeneralAnswer { multipliers, iterations, infeasible, .. } = solve_general(&program.transposed, &[], &program.offsets)?;
    Some(Answer { multipliers, iterations, infeasible })
}

/// The least `x` with `B x = b` and `A x + c >= 0`, where columns of `transposed` are the rows of `B`, then those of `A`; `None` if the solver does not
/// accept it.
pub fn solve_general(transposed: &CscMatrix<f64>, equations: &[f64], offsets: &[f64]) -> Option<GeneralAnswer> {
    let equal = (!equations.is_empty()).then_some(SupportedConeT::ZeroConeT(equations.len()));
    let cones: Vec<SupportedConeT<f64>> = equal.into_iter().chain([SupportedConeT::NonnegativeConeT(offsets.len())]).collect();
    let sides: Vec<f64> = equations.iter().map(|side| -side).chain(offsets.iter().copied()).collect();
    let mut answer = solve_in_cones(transposed, &sides, &cones)?;
    answer.multipliers = answer.multipliers.split_off(equations.len());
    answer.slacks = answer.slacks.split_off(equations.len());
    Some(answer)
}

/// The least `x` with `A x + c` in cones, where columns of `transposed` are the rows of `A`; `None` if the solver does not accept it.
pub fn solve_in_cones(transposed: &CscMatrix<f64>, offsets: &[f64], cones: &[SupportedConeT<f64>]) -> Option<GeneralAnswer> {
    let unknowns = transposed.m;
    let metric = CscMatrix::identity(unknowns);
    let mut matrix = CscMatrix::from(transposed.t());
    matrix.nzval.iter_mut().for_each(|value| *value = -*value);
    let settings = DefaultSettings {
        verbose: false,
        presolve_enable: false,
        max_threads: 1,
        tol_feas: FEASIBILITY,
        tol_gap_abs: DUALITY_GAP,
        tol_gap_rel: DUALITY_GAP,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(&metric, &vec![0.0; unknowns], &matrix, offsets, cones, settings).ok()?;
    solver.solve();
    let status = solver.solution.status;
    let infeasible = matches!(status, SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible);
    let solved = matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    Some(GeneralAnswer {
        multipliers: solver.solution.z,
        slacks: solver.solution.s,
        iterations: solver.solution.iterations as usize,
        infeasible,
        solved,
    })
}
