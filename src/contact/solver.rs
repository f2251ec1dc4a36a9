//! Which method solves the program of an island.
//!
//! Both end in an active set and are held to the same tolerance.

use super::{
    active_set::{active_set_refine, active_set_refine_exactly},
    clarabel::solve_by_clarabel,
    factors::Factors,
    interior_point::{Distance, InteriorPoint},
    program::{Answer, Program, clip},
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

/// Overlap left over, in the scale of the largest violation, and work of the forces on open gaps, as a part of all their
/// work, up to which a solution is one. A contact that is about to press may have a little of both, gap and force.
const TOLERANCE: f64 = 1e-7;

/// How the forces of an island are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Solver {
    /// No contact has to be solved for, or one alone, by a formula.
    Formula,
    /// By an interior point that factors one block for each body, and an active set: the fastest.
    Sparse,
    /// By an interior point for any cone (Clarabel), and an active set: the surest.
    General,
    /// As `Sparse`, by all ranks together, which share the factors (MUMPS).
    Distributed,
}

impl Solver {
    /// All of them, in order.
    pub const ALL: [Solver; 4] = [Solver::Formula, Solver::Sparse, Solver::General, Solver::Distributed];
}

/// How an island was solved.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// By forces, one for each contact, in so many iterations.
    Solved {
        /// The forces.
        forces: Vec<f64>,
        /// Iterations of the method.
        iterations: usize,
        /// The method.
        solver: Solver,
    },
    /// Not at all: no velocities let nothing overlap.
    Infeasible,
    /// Not at all: the solver gave up.
    NotConverged,
}

/// The solution of a program by the first of several methods that finds it, and which; or what went wrong.
pub(super) fn solve_first(program: &Program, guess: &[f64], solvers: &[Solver]) -> Result<(Answer, Solver), Outcome> {
    let mut infeasible = false;
    let found = solvers.iter().find_map(|&solver| {
        let answer = solve(program, guess, solver)?;
        infeasible |= answer.infeasible;
        program.solved(&answer.multipliers, TOLERANCE).then_some((answer, solver))
    });
    match found {
        Some(found) => Ok(found),
        None if infeasible => Err(Outcome::Infeasible),
        None => Err(Outcome::NotConverged),
    }
}

/// The multipliers of a program by a method, if it accepts it; whether they solve it the caller must see.
fn solve(program: &Program, guess: &[f64], solver: Solver) -> Option<Answer> {
    if solver != Solver::General {
        let (multipliers, iterations) = along_the_path(program, guess);
        return Some(Answer { multipliers, iterations, infeasible: false });
    }
    let Answer { multipliers, iterations, infeasible } = solve_by_clarabel(program)?;
    Some(Answer { multipliers: active_set_refine(program, &mut Factors::new(program), &multipliers), iterations, infeasible })
}

/// The multipliers, and how many iterations they took.
fn along_the_path(program: &Program, guess: &[f64]) -> (Vec<f64>, usize) {
    let mut guess = guess.to_vec();
    clip(&mut guess);
    // a crystal that stands still has nothing to gain
    if program.solved(&guess, EXACT) {
        return (guess, 0);
    }
    let mut factors = Factors::new(program);
    if program.any(guess.iter().any(|&multiplier| multiplier > 0.0)) {
        let exact = active_set_refine_exactly(program, &mut factors, &guess);
        if program.solved(&exact, STILL) {
            return (exact, 1);
        }
    }
    let (multipliers, iterations) = follow(program, &mut factors, &guess);
    (active_set_refine(program, &mut factors, &multipliers), iterations)
}

/// Goes along the path from near a guess: the multipliers that press at its end, or exact ones found on the way, and how many iterations it took.
fn follow(program: &Program, factors: &mut Factors, guess: &[f64]) -> (Vec<f64>, usize) {
    let mut point = InteriorPoint::new(program, guess);
    let (mut earlier, mut tried) = (point.distance().work, f64::INFINITY);
    for iteration in 1..=ITERATIONS {
        let goes_on = point.step(factors);
        let Distance { violation, work } = point.distance();
        if !goes_on || violation <= END[0] && work <= END[1] {
            return (point.pressing(), iteration);
        }
        if work < FALL * earlier && work < NEAR.min(AGAIN * tried) {
            tried = work;
            let exact = active_set_refine_exactly(program, factors, &point.pressing());
            if program.solved(&exact, EXACT) {
                return (exact, iteration);
            }
        }
        earlier = work;
    }
    (point.pressing(), ITERATIONS)
}
