//! Which method solves the program of an island.
//!
//! Both end in an active set and are held to the same tolerance.

use super::{
    active::{polish, sharpen},
    augmented::Augmented,
    dual::Descent,
    interior::interior_point,
    program::Program,
};

/// Iterations of conjugate gradients before Newton's method. In a collapsing pile of 10,000 equal disks this many take as long as a few
/// factorisations and find most of who presses: with 60 of them Newton's method gave up in every other step.
const ITERATIONS: usize = 2000;
/// What Newton's method is asked for; the active set does the rest.
const GOAL: f64 = 5e-8;

/// What the active set is not asked to improve.
const EXACT: f64 = 1e-10;

/// How the forces of an island are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solver {
    /// No contact has to be solved for, or one alone, by a formula.
    Formula,
    /// By an interior point and an active set: the surest.
    Interior,
    /// By conjugate gradients on the forces, an augmented Lagrangian, and an active set: the fastest for many contacts.
    Newton,
}

impl Solver {
    /// All of them, in order.
    pub const ALL: [Solver; 3] = [Solver::Formula, Solver::Interior, Solver::Newton];
}

/// What a method found.
pub(super) struct Answer {
    /// The multipliers.
    pub multipliers: Vec<f64>,
    /// Iterations of the method.
    pub iterations: usize,
    /// Whether it found that no unknowns meet all constraints.
    pub infeasible: bool,
}

/// The multipliers of a program by a method, if it accepts it; whether they solve it the caller must see.
pub(super) fn solve(program: &Program, guess: &[f64], solver: Solver) -> Option<Answer> {
    if solver == Solver::Newton {
        return Some(by_newton(program, guess));
    }
    let Answer { multipliers, iterations, infeasible } = interior_point(program)?;
    Some(Answer { multipliers: polish(program, &multipliers), iterations, infeasible })
}

fn by_newton(program: &Program, guess: &[f64]) -> Answer {
    let mut descent = Descent::new(program, guess);
    descent.run(GOAL, ITERATIONS);
    let iterations = descent.iterations;
    let mut augmented = Augmented::new(program, descent.multipliers);
    if !program.solved(&augmented.multipliers, GOAL) {
        augmented.run(GOAL);
    }
    let Augmented { multipliers, steps, .. } = augmented;
    // a crystal that stands still has nothing to gain
    let multipliers = if program.solved(&multipliers, EXACT) { multipliers } else { sharpen(program, &multipliers) };
    Answer { iterations: iterations + steps, multipliers, infeasible: false }
}
