//! Multipliers that may fall below zero, down to a floor of their own: the same program from another origin.
//!
//! With `z = floor + y`, `y >= 0`, the slacks `A A^T z + c` are those of a program with the offsets `c + A A^T floor`. A contact
//! that was pressed for long has a floor far below all other numbers, which would drown them: lower bounds are first taken to be no
//! lower than what moves the bodies of the island, and lowered as long as a contact rests on one that is not its own.

use super::{
    Outcome,
    program::{Answer, Program},
    solve_first,
};
use crate::contact::Solver;

/// The first limit of lower bounds, in the unit of the program, and the factor by which it grows.
const LIMIT: f64 = 16.0;

/// Multipliers not below the lower bounds, of which none is positive, from a guess, by the first of several methods that finds them.
pub fn solve_above(program: Program, lower_bounds: &[f64], guess: &[f64], solvers: &[Solver]) -> Result<(Answer, Solver), Outcome> {
    if !program.any(lower_bounds.iter().any(|&floor| floor != 0.0)) {
        return solve_first(&program, guess, solvers);
    }
    let (mut limit, mut total) = (LIMIT, 0);
    loop {
        let limited: Vec<f64> = lower_bounds.iter().map(|floor| floor.max(-limit)).collect();
        let moved = Program { transposed: program.transposed.clone(), offsets: program.slacks(&limited), ..program };
        let raised: Vec<f64> = guess.iter().zip(&limited).map(|(guess, floor)| (guess - floor).max(0.0)).collect();
        let (above, solver) = solve_first(&moved, &raised, solvers)?;
        total += above.iterations;
        let rests = |place: usize| above.multipliers[place] == 0.0 && limited[place] > lower_bounds[place];
        if !program.any((0..lower_bounds.len()).any(rests)) {
            let multipliers = above.multipliers.iter().zip(limited).map(|(above, floor)| above + floor).collect();
            return Ok((Answer { multipliers, iterations: total, ..above }, solver));
        }
        limit *= LIMIT;
    }
}
