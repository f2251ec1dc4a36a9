//! The active set: from a good guess to a solution exact to rounding.
//!
//! Constraints that are guessed active, `z > s`, become equations. The multipliers that they ask for tell the
//! next guess, until it repeats (Hintermüller, Ito and Kunisch 2002, doi:10.1137/S1052623401383558). Equations
//! may repeat each other, as in a crystal: of all their solutions the one nearest to the guess is taken,
//! by iterations on a slightly regularised matrix.

use super::{
    factors::Factors,
    program::{Program, clip},
};

/// Guesses tried with each regularization.
const GUESSES: usize = 8;
/// A guess that differs from the one before in more rows, or in a greater part of all, is not followed: equations are then no way to the solution.
const ASTRAY_ROWS: f64 = 16.0;
const ASTRAY_PART: f64 = 0.01;
/// Short steps, which lead to the active set also where many constraints neither press nor gape, and exact equations.
const STAGES: [Stage; 2] = [Stage { softness: 1e-4, corrections: 2 }, Stage { softness: 1e-6, corrections: 60 }];
/// A correction that leaves more than this part of the residual is the last one: a body of a millionth of the mass of those that squeeze it leaves half,
/// equations without a solution all.
const SLOWEST: f64 = 0.9;
/// The part of the residual that a slack must have for an equation to stay open.
const OPEN: f64 = 0.1;
/// A residual of this many roundings of the largest multiplier is none.
const ROUNDINGS: f64 = 8.0;

/// How exactly the equations of an active set are solved.
#[derive(Clone, Copy)]
struct Stage {
    /// What makes the matrix of repeated equations invertible.
    softness: f64,
    /// How often the regularized solution is corrected.
    corrections: usize,
}

/// Multipliers at least as good as the guess: the best found, none negative.
pub fn active_set_refine(program: &Program, factors: &mut Factors, guess: &[f64]) -> Vec<f64> {
    let mut best = Best::new(program, guess);
    for stage in STAGES {
        best.improve(program, factors, stage);
        if best.residual <= rounding(program, &best.multipliers) {
            break;
        }
    }
    best.multipliers
}

/// Multipliers at least as good as the guess, by exact equations only.
pub fn active_set_refine_exactly(program: &Program, factors: &mut Factors, guess: &[f64]) -> Vec<f64> {
    let mut best = Best::new(program, guess);
    best.improve(program, factors, STAGES[1]);
    best.multipliers
}

/// Multipliers at least as good, where equations that repeat each other contradict each other by little: the weakest of those that stay open gives way.
pub fn without_weakest(program: &Program, factors: &mut Factors, multipliers: Vec<f64>) -> Vec<f64> {
    let mut best = Best::new(program, &multipliers);
    if program.sharing.is_some() || best.residual <= rounding(program, &multipliers) {
        return multipliers;
    }
    let slacks = program.slacks(&multipliers);
    let open = (0..slacks.len()).filter(|&row| multipliers[row] > slacks[row] && slacks[row] > OPEN * best.residual);
    let Some(weakest) = open.min_by(|&one, &other| multipliers[one].total_cmp(&multipliers[other])) else { return multipliers };
    let active: Vec<bool> = (0..slacks.len()).map(|row| multipliers[row] > slacks[row] && row != weakest).collect();
    let trial = Best::new(program, &solve_equations(program, factors, &active, &multipliers, STAGES[1]));
    if trial.residual < best.residual {
        best = trial;
    }
    best.multipliers
}

/// The best multipliers so far.
struct Best {
    multipliers: Vec<f64>,
    residual: f64,
}

impl Best {
    fn new(program: &Program, guess: &[f64]) -> Self {
        let mut multipliers = guess.to_vec();
        clip(&mut multipliers);
        Self { residual: program.residual(&multipliers), multipliers }
    }

    fn improve(&mut self, program: &Program, factors: &mut Factors, stage: Stage) {
        let mut trial = self.multipliers.clone();
        let mut earlier: Option<Vec<bool>> = None;
        for _ in 0..GUESSES {
            let slacks = program.slacks(&trial);
            let active: Vec<bool> = trial.iter().zip(&slacks).map(|(multiplier, slack)| multiplier > slack).collect();
            let changes = earlier.map(|earlier| program.sum(active.iter().zip(&earlier).map(|(now, before)| f64::from(now != before))));
            if changes.is_some_and(|changes| changes == 0.0 || changes > ASTRAY_ROWS.max((ASTRAY_PART * program.count()).floor())) {
                return;
            }
            trial = solve_equations(program, factors, &active, &trial, stage);
            let found = Self::new(program, &trial);
            if found.residual < self.residual {
                *self = found;
            }
            if self.residual <= rounding(program, &self.multipliers) {
                return;
            }
            earlier = Some(active);
        }
    }
}

/// Multipliers, zero outside the active set, with which no active constraint has any slack: corrections by the augmented Lagrangian.
fn solve_equations(program: &Program, factors: &mut Factors, active: &[bool], guess: &[f64], stage: Stage) -> Vec<f64> {
    let Stage { softness, corrections } = stage;
    let mut multipliers: Vec<f64> = guess.iter().zip(active).map(|(guess, active)| if *active { guess.max(0.0) } else { 0.0 }).collect();
    let weights: Vec<f64> = active.iter().map(|active| if *active { 1.0 / softness } else { 0.0 }).collect();
    factors.factor(&weights);
    let (mut unknowns, mut changes) = (vec![0.0; program.transposed.m], vec![0.0; active.len()]);
    let mut earlier = f64::INFINITY;
    for _ in 0..corrections {
        let slacks = program.slacks(&multipliers);
        let pressing = slacks.iter().zip(active).filter(|(_, active)| **active);
        let largest = program.max(pressing.map(|(slack, _)| slack.abs()).fold(0.0, f64::max));
        if largest <= rounding(program, &multipliers) || largest > SLOWEST * earlier {
            break;
        }
        earlier = largest;
        changes.iter_mut().zip(slacks.iter().zip(&weights)).for_each(|(change, (slack, weight))| *change = -slack * weight);
        program.apply_transpose(&changes, &mut unknowns);
        factors.solve(&mut unknowns);
        program.apply(&unknowns, &mut changes);
        for (row, multiplier) in multipliers.iter_mut().enumerate() {
            *multiplier -= (slacks[row] + changes[row]) * weights[row];
        }
    }
    multipliers
}

/// The residual that rounding leaves.
pub fn rounding(program: &Program, multipliers: &[f64]) -> f64 {
    ROUNDINGS * f64::EPSILON * program.max(multipliers.iter().fold(1.0, |largest: f64, multiplier| largest.max(multiplier.abs())))
}
