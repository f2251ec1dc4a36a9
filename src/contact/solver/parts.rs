//! The parts of an island: constraints that press, or nearly, and hang together by them, solved one part after the other.
//!
//! An island holds all pairs of bodies that are near each other, of which most do not touch in a step. Without these it falls apart.
//! A constraint that was left out and is violated joins in the next round, and the parts that it touches are solved again.

use clarabel::algebra::CscMatrix;

use super::{program::Program, projected_gradient::descend};
use crate::contact::union_find::UnionFind;

/// Constraints that press, or of which the slack is below the first, are looked at in so many iterations of the projected gradient: first in a few, then
/// those of which the slack is low after these.
const GLANCES: [(f64, usize); 2] = [(0.7, 15), (0.4, 60)];
/// Constraints are solved for that press after them or have less slack than so many times the distance from the solution, between these bounds.
const NEAR: f64 = 20.0;
const BOUNDS: [f64; 2] = [0.01, 0.2];
/// Those that were left out join if they are violated by more.
const TOLERANCE: f64 = 1e-13;
/// Rounds before giving up.
const ROUNDS: usize = 30;
/// The smallest unit of a part, in that of the program.
const SMALLEST_UNIT: f64 = 1e-3;

/// What solves a part from a guess: the multipliers, and the iterations it took.
pub type SolvePart<'a> = &'a dyn Fn(&Program, &[f64]) -> (Vec<f64>, usize);

/// The multipliers of a program that one rank has, if its parts have solutions, and the most iterations on a part.
pub fn solve_by_parts(program: &Program, guess: &[f64], solve: SolvePart) -> (Vec<f64>, usize) {
    let mut parts = Parts::new(program, guess);
    parts.descend();
    let near = (NEAR * program.residual(&parts.multipliers)).clamp(BOUNDS[0], BOUNDS[1]);
    for round in 0..ROUNDS {
        let least = if round == 0 { near } else { -TOLERANCE };
        let fresh = parts.choose(least);
        if fresh.is_empty() {
            break;
        }
        for rows in parts.with(&fresh) {
            parts.solve(&rows, solve);
        }
    }
    (parts.multipliers, parts.iterations)
}

/// Where the rounds stand.
struct Parts<'a> {
    program: &'a Program<'a>,
    multipliers: Vec<f64>,
    /// Whether a constraint is solved for.
    chosen: Vec<bool>,
    iterations: usize,
    /// Memory for the place of each body in a part.
    places: Vec<usize>,
}

impl<'a> Parts<'a> {
    fn new(program: &'a Program<'a>, guess: &[f64]) -> Self {
        let bodies = program.transposed.m / program.width;
        Self { program, multipliers: guess.to_vec(), chosen: vec![false; guess.len()], iterations: 0, places: vec![0; bodies] }
    }

    /// Constraints that press, and those with less slack than this.
    fn pressing_or_below(&self, least: f64) -> impl Iterator<Item = usize> {
        let slacks = self.program.slacks(&self.multipliers);
        (0..slacks.len()).filter(move |&row| self.multipliers[row] > 0.0 || slacks[row] < least)
    }

    /// Improves the guess where anything may press.
    fn descend(&mut self) {
        for (reach, iterations) in GLANCES {
            let rows: Vec<usize> = self.pressing_or_below(reach).collect();
            let (part, guess) = self.restricted(&rows, 1.0);
            self.put(&rows, descend(&part, &guess, iterations), 1.0);
        }
    }

    /// Chooses constraints; gives those that were not chosen before.
    fn choose(&mut self, least: f64) -> Vec<usize> {
        let fresh: Vec<usize> = self.pressing_or_below(least).filter(|&row| !self.chosen[row]).collect();
        fresh.iter().for_each(|&row| self.chosen[row] = true);
        fresh
    }

    /// The chosen constraints that hang together, of each set with a fresh one.
    fn with(&self, fresh: &[usize]) -> Vec<Vec<usize>> {
        let rows = || (0..self.chosen.len()).filter(|&row| self.chosen[row]);
        let mut sets = UnionFind::new(self.places.len());
        for [one, two] in rows().map(|row| self.program.bodies(row)) {
            sets.join(one, two);
        }
        let (mut numbers, mut count) = (vec![None; self.places.len()], 0);
        for &row in fresh {
            numbers[sets.root(self.program.bodies(row)[0])].get_or_insert_with(|| {
                count += 1;
                count - 1
            });
        }
        let mut parts = vec![Vec::new(); count];
        for row in rows() {
            if let Some(number) = numbers[sets.root(self.program.bodies(row)[0])] {
                parts[number].push(row);
            }
        }
        parts
    }

    /// Solves a part in its own unit: its largest violation without forces.
    fn solve(&mut self, rows: &[usize], solve: SolvePart) {
        let violation = rows.iter().map(|&row| -self.program.offsets[row]).fold(0.0, f64::max);
        if violation == 0.0 {
            return self.put(rows, vec![0.0; rows.len()], 1.0);
        }
        let unit = violation.max(SMALLEST_UNIT);
        let (part, guess) = self.restricted(rows, unit);
        let (multipliers, iterations) = solve(&part, &guess);
        self.put(rows, multipliers, unit);
        self.iterations = self.iterations.max(iterations);
    }

    fn put(&mut self, rows: &[usize], multipliers: Vec<f64>, unit: f64) {
        rows.iter().zip(multipliers).for_each(|(&row, multiplier)| self.multipliers[row] = multiplier * unit);
    }

    /// The program of some of the constraints and their bodies in another unit, with the guess.
    fn restricted(&mut self, rows: &[usize], unit: f64) -> (Program<'static>, Vec<f64>) {
        let (program, width) = (self.program, self.program.width);
        let mut bodies: Vec<usize> = rows.iter().flat_map(|&row| program.bodies(row)).collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies.iter().enumerate().for_each(|(place, &body)| self.places[body] = place);
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for &row in rows {
            places.extend(program.row(row).map(|(entry, _)| self.places[entry / width] * width + entry % width));
            values.extend(program.values(row));
            starts.push(places.len());
        }
        let part = Program {
            transposed: CscMatrix::new(bodies.len() * width, rows.len(), starts, places, values),
            width,
            offsets: rows.iter().map(|&row| program.offsets[row] / unit).collect(),
            sharing: None,
        };
        (part, rows.iter().map(|&row| self.multipliers[row] / unit).collect())
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::contact::solver::{clarabel::solve_by_clarabel, solve_part};

    /// Bodies in a row of which some neighbours, and some next to these, are constrained along random directions: so many violated of ten.
    fn row(bodies: usize, violated: usize, seed: u64) -> Program<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (mut starts, mut places, mut values, mut offsets) = (vec![0], Vec::new(), Vec::new(), Vec::new());
        for body in 0..bodies - 2 {
            for other in [body + 1, body + 2] {
                let (sine, cosine) = (random.random::<f64>() * std::f64::consts::TAU).sin_cos();
                places.extend([2 * body, 2 * body + 1, 2 * other, 2 * other + 1]);
                values.extend([-cosine, -sine, cosine, sine].map(|value| value * 0.5f64.sqrt()));
                starts.push(places.len());
                let size: f64 = random.random();
                offsets.push(if random.random_range(0..10) < violated { -size } else { size });
            }
        }
        let transposed = CscMatrix::new(2 * bodies, offsets.len(), starts, places, values);
        Program { transposed, width: 2, offsets, sharing: None }
    }

    fn unknowns(program: &Program, multipliers: &[f64]) -> Vec<f64> {
        let mut unknowns = vec![0.0; program.transposed.m];
        program.apply_transpose(multipliers, &mut unknowns);
        unknowns
    }

    #[test]
    fn parts_give_what_the_general_method_gives_for_the_whole_from_any_guess() {
        for (seed, violated) in (0..20).map(|seed| (seed, 1 + seed as usize % 6)) {
            let program = row(120, violated, seed);
            let expected = unknowns(&program, &solve_by_clarabel(&program).unwrap().multipliers);
            for size in [0.0, 1.0, 1e3] {
                let guess: Vec<f64> = (0..program.offsets.len()).map(|row| size * (row * 7919 % 11) as f64).collect();
                let (found, _) = solve_by_parts(&program, &guess, &solve_part);
                assert!(program.residual(&found) < 1e-9, "{:e} from {size}", program.residual(&found));
                let found = unknowns(&program, &found);
                let apart = found.iter().zip(&expected).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-7, "{apart:e} from {size} with seed {seed}");
            }
        }
    }

    #[test]
    fn constraints_that_hang_together_by_open_ones_alone_are_solved_apart() {
        let mut program = row(90, 0, 7);
        for start in [0, 60, 120] {
            program.offsets[start..start + 3].fill(-0.5);
        }
        program.offsets.iter_mut().filter(|offset| **offset > 0.0).for_each(|offset| *offset += 5.0);
        let sizes = std::cell::RefCell::new(Vec::new());
        let solve = |part: &Program, guess: &[f64]| {
            sizes.borrow_mut().push(part.offsets.len());
            solve_part(part, guess)
        };
        let (found, _) = solve_by_parts(&program, &vec![0.0; program.offsets.len()], &solve);
        assert!(program.residual(&found) < 1e-12 && *sizes.borrow() == [3; 3], "{sizes:?}");
    }
}
