//! The projected gradient, accelerated: many cheap iterations that tell which constraints press.
//!
//! Each takes `z` from an extrapolated point against the slacks there, and cuts it off at zero (Nesterov 1983); the extrapolation starts again where
//! it leads uphill (O'Donoghue and Candès 2015, doi:10.1007/s10208-013-9150-3; for contacts Mazhar et al. 2015, doi:10.1145/2735627).
//! What presses weakly at the end of long chains of contacts it finds too slowly to be a method of its own.

use super::program::{Program, clip};
use crate::linalg::{ROUNDING, dot};

/// The largest eigenvalue of `A A^T` that is assumed at first: disks of one size in a dense crowd have 2 to 3.
const STIFFNESS: f64 = 2.5;
/// What it grows by where it was too small.
const STIFFER: f64 = 1.3;
/// Multipliers after so many iterations from a guess.
pub fn descend(program: &Program, guess: &[f64], iterations: usize) -> Vec<f64> {
    let mut descent = Descent::new(program, guess);
    for _ in 0..iterations {
        descent.step();
    }
    descent.multipliers
}

/// Where the method stands.
struct Descent<'a> {
    program: &'a Program<'a>,
    multipliers: Vec<f64>,
    /// `A^T z`.
    unknowns: Vec<f64>,
    /// The extrapolated point, and its unknowns.
    ahead: Vec<f64>,
    unknowns_ahead: Vec<f64>,
    momentum: f64,
    stiffness: f64,
    /// Memory of the next point.
    next: Vec<f64>,
    next_unknowns: Vec<f64>,
    slacks: Vec<f64>,
}

impl<'a> Descent<'a> {
    fn new(program: &'a Program<'a>, guess: &[f64]) -> Self {
        let (mut multipliers, mut unknowns) = (guess.to_vec(), vec![0.0; program.transposed.m]);
        clip(&mut multipliers);
        program.apply_transpose(&multipliers, &mut unknowns);
        Self {
            program,
            ahead: multipliers.clone(),
            unknowns_ahead: unknowns.clone(),
            momentum: 1.0,
            stiffness: STIFFNESS,
            next: multipliers.clone(),
            next_unknowns: unknowns.clone(),
            slacks: vec![0.0; multipliers.len()],
            multipliers,
            unknowns,
        }
    }

    fn step(&mut self) {
        self.program.apply(&self.unknowns_ahead, &mut self.slacks);
        let mut uphill = 0.0;
        for (row, next) in self.next.iter_mut().enumerate() {
            let ahead = self.ahead[row];
            *next = (ahead - (self.slacks[row] + self.program.offsets[row]) / self.stiffness).max(0.0);
            uphill += (ahead - *next) * (*next - self.multipliers[row]);
        }
        self.program.apply_transpose(&self.next, &mut self.next_unknowns);
        if self.overshoots() {
            self.stiffness *= STIFFER;
            return self.start_again();
        }
        std::mem::swap(&mut self.multipliers, &mut self.next);
        std::mem::swap(&mut self.unknowns, &mut self.next_unknowns);
        if uphill > 0.0 {
            return self.start_again();
        }
        let momentum = 0.5 * (1.0 + (1.0 + 4.0 * self.momentum * self.momentum).sqrt());
        let part = (self.momentum - 1.0) / momentum;
        self.momentum = momentum;
        extrapolate(&mut self.ahead, &self.multipliers, &self.next, part);
        extrapolate(&mut self.unknowns_ahead, &self.unknowns, &self.next_unknowns, part);
    }

    /// Whether the step went farther than the curvature along it allows.
    fn overshoots(&self) -> bool {
        let squared = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| (one - other) * (one - other)).sum::<f64>();
        let bound = self.stiffness * squared(&self.next, &self.ahead);
        squared(&self.next_unknowns, &self.unknowns_ahead) > bound * (1.0 + ROUNDING) + f64::EPSILON * dot(&self.unknowns, &self.unknowns)
    }

    fn start_again(&mut self) {
        self.momentum = 1.0;
        self.ahead.copy_from_slice(&self.multipliers);
        self.unknowns_ahead.copy_from_slice(&self.unknowns);
    }
}

fn extrapolate(target: &mut [f64], now: &[f64], before: &[f64], part: f64) {
    for (target, (now, before)) in target.iter_mut().zip(now.iter().zip(before)) {
        *target = now + part * (now - before);
    }
}

#[cfg(test)]
mod tests {
    use clarabel::algebra::CscMatrix;

    use super::*;

    /// A row of bodies pushed together, each `ratio` times as heavy as the one before or after it.
    fn row(bodies: usize, ratio: f64) -> Program<'static> {
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for body in 0..bodies - 1 {
            let ease = [body, body + 1].map(|body| if body % 2 == 0 { 1.0 } else { 1.0 / ratio });
            let root = (ease[0] + ease[1]).sqrt();
            places.extend(2 * body..2 * body + 4);
            values.extend([-ease[0].sqrt() / root, 0.0, ease[1].sqrt() / root, 0.0]);
            starts.push(places.len());
        }
        let transposed = CscMatrix::new(2 * bodies, bodies - 1, starts, places, values);
        Program { transposed, width: 2, offsets: vec![-1.0; bodies - 1], sharing: None }
    }

    #[test]
    fn short_rows_are_solved_whatever_the_masses_and_the_guess() {
        for ratio in [0.1, 1.0, 10.0] {
            for guess in [0.0, 1.0, 1e3] {
                let program = row(6, ratio);
                let found = descend(&program, &[guess; 5], 2000);
                assert!(program.residual(&found) < 1e-8, "{:e} with {ratio} from {guess}", program.residual(&found));
            }
        }
    }
}
