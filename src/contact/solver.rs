//! Which method solves the program of an island.
//!
//! Both end in the same active set ([`polish`]) and are held to the same tolerance.

use super::{active::polish, augmented::Augmented, dual::Descent, interior::interior_point, program::Program};

/// Iterations of conjugate gradients before Newton's method: they find out cheaply who presses.
const ITERATIONS: usize = 60;
/// What Newton's method is asked for; the active set does the rest.
const GOAL: f64 = 1e-8;

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
    let Answer { multipliers, iterations, infeasible } = match solver {
        Solver::Newton => by_newton(program, guess),
        _ => interior_point(program)?,
    };
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
    Answer { iterations: iterations + augmented.steps, multipliers: augmented.multipliers, infeasible: false }
}
