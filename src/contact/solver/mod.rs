//! Which method solves the program of an island.
//!
//! Both end in an active set and are held to the same tolerance.

mod active_set;
pub mod block_lu;
mod cholesky;
pub mod clarabel;
mod dense_part;
mod factors;
mod interior_point;
pub mod lower_bounds;
mod parts;
pub mod program;
mod projected_gradient;
mod shared_factors;
pub mod sharing;

use self::{
    active_set::{active_set_refine, active_set_refine_exactly, rounding, without_weakest},
    clarabel::solve_by_clarabel,
    dense_part::solve_dense,
    factors::Factors,
    interior_point::{Distance, InteriorPoint},
    parts::solve_by_parts,
    program::{Answer, Program, clip},
};
use crate::linalg::dot;

/// Iterations along the central path before giving up.
const ITERATIONS: usize = 60;
/// Where the path ends: the most that a constraint is violated.
const VIOLATION: f64 = 1e-9;
/// And the work on slacks: the active set is asked for at the first, and if that finds no solution, at the second. Where many constraints neither press
/// nor gape, the work falls to a third from iteration to iteration, and the larger of a slack and its multiplier with the root of it.
const ENDS: [f64; 2] = [1e-10, 1e-13];
/// Work from which the active set is tried if the work fell by so much in an iteration, and what it must fall by to try again.
const NEAR: f64 = 1e-5;
const FALL: f64 = 0.1;
const AGAIN: f64 = 1e-3;
/// What the active set is asked for before the path has ended.
const EXACT: f64 = 1e-10;
/// What the forces of the step before are asked for to be taken as they are, or so many roundings of an active set.
const UNCHANGED: f64 = 1e-12;
const ROUNDINGS: f64 = 10.0;
/// What they are asked for to need no scaling, and a method's answer to need no other.
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
pub enum Outcome {
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
pub fn solve_first(program: &Program, guess: &[f64], solvers: &[Solver]) -> Result<(Answer, Solver), Outcome> {
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
        let guess = scaled(program, guess);
        let (multipliers, iterations) = by_parts(program, &guess).unwrap_or_else(|| along_the_path(program, &guess));
        return Some(Answer { multipliers, iterations, infeasible: false });
    }
    let Answer { multipliers, iterations, infeasible } = solve_by_clarabel(program)?;
    Some(Answer { multipliers: active_set_refine(program, &mut Factors::new(program), &multipliers), iterations, infeasible })
}

/// The guess without negative multipliers and, if it is not exact and one rank has the program, times what makes the best of it, which may be zero.
fn scaled(program: &Program, guess: &[f64]) -> Vec<f64> {
    let mut guess = guess.to_vec();
    clip(&mut guess);
    if program.sharing.is_some() || program.solved(&guess, STILL) {
        return guess;
    }
    let mut unknowns = vec![0.0; program.transposed.m];
    program.apply_transpose(&guess, &mut unknowns);
    let (work, square) = (-program.dot(&program.offsets, &guess), dot(&unknowns, &unknowns));
    let factor = if work > 0.0 && square > 0.0 { work / square } else { 0.0 };
    guess.iter_mut().for_each(|multiplier| *multiplier *= factor);
    guess
}

/// The same part by part of a program that one rank has, if that solves it.
fn by_parts(program: &Program, guess: &[f64]) -> Option<(Vec<f64>, usize)> {
    // a crystal that stands still has nothing to gain
    if program.sharing.is_some() || unchanged(program, guess) {
        return None;
    }
    let (multipliers, iterations) = solve_by_parts(program, guess, &solve_part);
    program.solved(&multipliers, STILL).then_some((multipliers, iterations))
}

/// The multipliers of a part from a guess that is not exact.
pub fn solve_part(program: &Program, guess: &[f64]) -> (Vec<f64>, usize) {
    if let [offset] = program.offsets[..] {
        // rows have norm 1
        return (vec![(-offset).max(0.0)], 1);
    }
    if let Some(found) = solve_dense(program, guess).filter(|found| program.residual(found) <= EXACT) {
        return (found, 1);
    }
    let mut factors = Factors::new(program);
    let exact = active_set_refine_exactly(program, &mut factors, guess);
    if program.residual(&exact) <= EXACT { (exact, 1) } else { to_the_ends(program, &mut factors, guess) }
}

/// Whether the forces of the step before solve this one to rounding.
fn unchanged(program: &Program, guess: &[f64]) -> bool {
    program.solved(guess, UNCHANGED.max(ROUNDINGS * rounding(program, guess)))
}

/// The multipliers, and how many iterations they took.
fn along_the_path(program: &Program, guess: &[f64]) -> (Vec<f64>, usize) {
    if unchanged(program, guess) {
        return (guess.to_vec(), 0);
    }
    let mut factors = Factors::new(program);
    if program.any(guess.iter().any(|&multiplier| multiplier > 0.0)) {
        let exact = active_set_refine_exactly(program, &mut factors, guess);
        if program.solved(&exact, STILL) {
            return (exact, 1);
        }
    }
    to_the_ends(program, &mut factors, guess)
}

/// The multipliers at the end of the path, and how many iterations they took.
fn to_the_ends(program: &Program, factors: &mut Factors, guess: &[f64]) -> (Vec<f64>, usize) {
    let (mut point, mut iterations, mut found) = (InteriorPoint::new(program, guess), 0, guess.to_vec());
    for work in ENDS {
        let end = follow(&mut point, factors, work, &mut iterations);
        found = active_set_refine(program, factors, &end.multipliers);
        if end.last || program.solved(&found, STILL) {
            break;
        }
    }
    (without_weakest(program, factors, found), iterations)
}

/// Where a method stopped on the path.
struct End {
    /// The multipliers that press there, or exact ones found on the way.
    multipliers: Vec<f64>,
    /// Whether it leads no farther.
    last: bool,
}

/// Goes along the path until the work on slacks is no more than this, and counts iterations.
fn follow(point: &mut InteriorPoint, factors: &mut Factors, end: f64, iterations: &mut usize) -> End {
    let (program, mut earlier, mut tried) = (point.program, point.distance().work, f64::INFINITY);
    while *iterations < ITERATIONS {
        *iterations += 1;
        let goes_on = point.step(factors);
        let Distance { violation, work } = point.distance();
        if !goes_on || violation <= VIOLATION && work <= end {
            return End { multipliers: point.pressing(), last: !goes_on };
        }
        if work < FALL * earlier && work < NEAR.min(AGAIN * tried) {
            tried = work;
            let exact = active_set_refine_exactly(program, factors, &point.pressing());
            if program.solved(&exact, EXACT) {
                return End { multipliers: exact, last: true };
            }
        }
        earlier = work;
    }
    End { multipliers: point.pressing(), last: true }
}
