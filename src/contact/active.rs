//! The active set: from a good guess to a solution exact to rounding.
//!
//! Constraints that are guessed active, `z > s`, become equations. The multipliers that they ask for tell the
//! next guess, until it repeats (Hintermüller, Ito and Kunisch 2002, doi:10.1137/S1052623401383558). Equations
//! may repeat each other, as in a crystal: of all their solutions the one nearest to the guess is taken,
//! by iterations on a slightly regularised matrix.

use clarabel::{
    algebra::CscMatrix,
    qdldl::{QDLDLFactorisation, QDLDLSettings},
};

use super::program::{Program, clip};

/// Guesses tried with each regularization.
const GUESSES: usize = 8;
/// What makes the matrix of repeated equations invertible, and how often the regularized solution is corrected:
/// exact equations; if they lead astray, short steps from the best multipliers so far, and exact equations again.
const STAGES: [(f64, usize); 3] = [(1e-9, 12), (1e-6, 2), (1e-9, 12)];
/// A residual of this many roundings of the largest multiplier is none.
const ROUNDINGS: f64 = 8.0;

/// Multipliers at least as good as the guess: the best found, none negative.
pub(super) fn polish(program: &Program, guess: &[f64]) -> Vec<f64> {
    let mut best = Best::new(program, guess);
    for stage in STAGES {
        best.improve(program, stage);
        if best.residual <= rounding(&best.multipliers) {
            break;
        }
    }
    best.multipliers
}

/// Multipliers at least as good as the guess, by exact equations only.
pub(super) fn sharpen(program: &Program, guess: &[f64]) -> Vec<f64> {
    let mut best = Best::new(program, guess);
    best.improve(program, STAGES[0]);
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

    fn improve(&mut self, program: &Program, stage: (f64, usize)) {
        let mut trial = self.multipliers.clone();
        let mut earlier = Vec::new();
        for _ in 0..GUESSES {
            let slacks = program.slacks(&trial);
            let active: Vec<usize> = (0..trial.len()).filter(|&row| trial[row] > slacks[row]).collect();
            let Some(next) = meet(program, &active, &trial, stage) else { return };
            trial = next;
            let found = Self::new(program, &trial);
            if found.residual < self.residual {
                *self = found;
            }
            if active == earlier || self.residual <= rounding(&self.multipliers) {
                return;
            }
            earlier = active;
        }
    }
}

/// Multipliers, zero outside the active set, with which no active constraint has any slack.
fn meet(program: &Program, active: &[usize], guess: &[f64], (regularization, corrections): (f64, usize)) -> Option<Vec<f64>> {
    let mut multipliers = vec![0.0; guess.len()];
    active.iter().for_each(|&row| multipliers[row] = guess[row]);
    clip(&mut multipliers);
    if active.is_empty() {
        return Some(multipliers);
    }
    let mut equations = Equations::new(program, active, regularization)?;
    let mut earlier = f64::INFINITY;
    for _ in 0..corrections {
        let slacks = program.slacks(&multipliers);
        let largest = active.iter().map(|&row| slacks[row].abs()).fold(0.0, f64::max);
        if largest <= rounding(&multipliers) || largest > 0.5 * earlier {
            break;
        }
        earlier = largest;
        let corrections = equations.solve(active.iter().map(|&row| slacks[row]));
        active.iter().zip(corrections).for_each(|(&row, correction)| multipliers[row] += correction);
    }
    multipliers.iter().all(|multiplier| multiplier.is_finite()).then_some(multipliers)
}

/// The factored matrix `[1, B^T; B, -e]`, where `B` holds the active rows.
pub(super) struct Equations {
    factors: QDLDLFactorisation<f64>,
    unknowns: usize,
}

impl Equations {
    pub fn new(program: &Program, active: &[usize], regularization: f64) -> Option<Self> {
        let unknowns = program.transposed.m;
        let (mut starts, mut rows, mut values) =
            ((0..=unknowns).collect::<Vec<_>>(), (0..unknowns).collect::<Vec<_>>(), vec![1.0; unknowns]);
        for (place, &constraint) in active.iter().enumerate() {
            for (row, value) in program.row(constraint).chain([(unknowns + place, -regularization)]) {
                rows.push(row);
                values.push(value);
            }
            starts.push(rows.len());
        }
        let size = unknowns + active.len();
        let signs = (0..size).map(|row| if row < unknowns { 1 } else { -1 }).collect();
        let settings = QDLDLSettings { Dsigns: Some(signs), ..QDLDLSettings::default() };
        let factors = QDLDLFactorisation::new(&CscMatrix::new(size, size, starts, rows, values), Some(settings)).ok()?;
        Some(Self { factors, unknowns })
    }

    /// Changes of the multipliers that take the slacks away.
    pub fn solve(&mut self, slacks: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut vector = vec![0.0; self.unknowns];
        vector.extend(slacks);
        self.factors.solve(&mut vector);
        vector.split_off(self.unknowns)
    }
}

fn rounding(multipliers: &[f64]) -> f64 {
    ROUNDINGS * f64::EPSILON * multipliers.iter().fold(1.0, |largest: f64, multiplier| largest.max(multiplier.abs()))
}
