//! Which method solves the program of an island.
//!
//! Both end in an active set and are held to the same tolerance.

use super::{
    active::{polish, sharpen},
    central::{Central, Distance},
    cholesky::Cholesky,
    interior::interior_point,
    program::{Program, clip},
};

/// Iterations along the central path before giving up.
const ITERATIONS: usize = 60;
/// Where the path ends: the most that a constraint is violated, and the work on slacks. Where many constraints neither press nor gape, the work
/// falls to a third from iteration to iteration, and the larger of a slack and its multiplier with the root of it.
const END: [f64; 2] = [1e-9, 1e-10];
/// Work from which the active set is tried if the work fell by so much in an iteration, and what it must fall by to try again.
const NEAR: f64 = 1e-5;
const FALL: f64 = 0.1;
const AGAIN: f64 = 1e-3;
/// What the active set is asked for before the path has ended.
const EXACT: f64 = 1e-10;
/// What the forces of the step before are asked for to need no more.
const STILL: f64 = 1e-9;

/// How the forces of an island are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solver {
    /// No contact has to be solved for, or one alone, by a formula.
    Formula,
    /// By an interior point that factors one block for each body, and an active set: the fastest.
    Sparse,
    /// By an interior point for any cone (Clarabel), and an active set: the surest.
    General,
}

impl Solver {
    /// All of them, in order.
    pub const ALL: [Solver; 3] = [Solver::Formula, Solver::Sparse, Solver::General];
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
    if solver == Solver::Sparse {
        let (multipliers, iterations) = along_the_path(program, guess);
        return Some(Answer { multipliers, iterations, infeasible: false });
    }
    let Answer { multipliers, iterations, infeasible } = interior_point(program)?;
    Some(Answer { multipliers: polish(program, &mut Cholesky::new(program), &multipliers), iterations, infeasible })
}

/// The multipliers, and how many iterations they took.
fn along_the_path(program: &Program, guess: &[f64]) -> (Vec<f64>, usize) {
    let mut guess = guess.to_vec();
    clip(&mut guess);
    // a crystal that stands still has nothing to gain
    if program.solved(&guess, EXACT) {
        return (guess, 0);
    }
    let mut factors = Cholesky::new(program);
    if guess.iter().any(|&multiplier| multiplier > 0.0) {
        let sharp = sharpen(program, &mut factors, &guess);
        if program.solved(&sharp, STILL) {
            return (sharp, 1);
        }
    }
    let (multipliers, iterations) = follow(program, &mut factors, &guess);
    (polish(program, &mut factors, &multipliers), iterations)
}

/// Goes along the path from near a guess: the multipliers that press at its end, or exact ones found on the way, and how many iterations it took.
fn follow(program: &Program, factors: &mut Cholesky, guess: &[f64]) -> (Vec<f64>, usize) {
    let mut central = Central::new(program, guess);
    let (mut earlier, mut tried) = (central.distance().work, f64::INFINITY);
    for iteration in 1..=ITERATIONS {
        let goes_on = central.step(factors);
        let Distance { violation, work } = central.distance();
        if !goes_on || violation <= END[0] && work <= END[1] {
            return (central.pressing(), iteration);
        }
        if work < FALL * earlier && work < NEAR.min(AGAIN * tried) {
            tried = work;
            let sharp = sharpen(program, factors, &central.pressing());
            if program.solved(&sharp, EXACT) {
                return (sharp, iteration);
            }
        }
        earlier = work;
    }
    (central.pressing(), ITERATIONS)
}
