//! Conjugate gradients among non-negative multipliers, for islands too large for a factorisation at every iteration.
//!
//! The multipliers minimise `1/2 |A^T z|^2 + c . z` over `z >= 0`, whose gradient are the slacks.
//! Conjugate gradients run among the multipliers that are free; a step that would make one negative ends there and is
//! followed by a short projected one; multipliers at zero are freed when their slacks outweigh those of the free ones
//! (modified proportioning with reduced gradient projections, Dostál and Schöberl 2005, doi:10.1007/s10589-005-4557-7).
//! An iteration costs one product with `A` and one with `A^T`, no more.

use super::program::{Program, clip};

/// Length of projected steps, times the largest eigenvalue of `A A^T`: they go downhill up to 2.
const STEP: f64 = 1.7;
/// Products spent on that eigenvalue.
const POWERS: usize = 15;

/// Where the method stands.
pub(super) struct Descent<'a> {
    program: &'a Program,
    /// The multipliers, none negative.
    pub multipliers: Vec<f64>,
    /// The iterations so far.
    pub iterations: usize,
    slacks: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    unknowns: Vec<f64>,
    step: f64,
}

/// What the slacks say about free multipliers and about those at zero.
struct Look {
    /// The least slack.
    least: f64,
    /// Free slacks times how far they lead, square.
    free: f64,
    /// Pulls on multipliers at zero, square.
    bound: f64,
}

impl<'a> Descent<'a> {
    /// Starts from a guess.
    pub fn new(program: &'a Program, guess: &[f64]) -> Self {
        let mut multipliers = guess.to_vec();
        clip(&mut multipliers);
        let slacks = program.slacks(&multipliers);
        let mut descent = Self {
            program,
            iterations: 0,
            direction: vec![0.0; slacks.len()],
            product: vec![0.0; slacks.len()],
            unknowns: vec![0.0; program.transposed.m],
            step: 0.0,
            multipliers,
            slacks,
        };
        descent.step = STEP / descent.largest_eigenvalue();
        descent.turn();
        descent
    }

    /// Goes on until the program is solved to a tolerance, or for so many iterations.
    pub fn run(&mut self, tolerance: f64, most: usize) {
        for _ in 0..most {
            let look = self.look();
            // slacks may not be exact after many steps
            if look.least >= -tolerance && self.program.solved(&self.multipliers, tolerance) {
                break;
            }
            self.iterations += 1;
            if look.bound <= look.free { self.explore() } else { self.proportion() }
        }
    }

    fn look(&self) -> Look {
        let mut look = Look { least: f64::INFINITY, free: 0.0, bound: 0.0 };
        for (&multiplier, &slack) in self.multipliers.iter().zip(&self.slacks) {
            look.least = look.least.min(slack);
            if multiplier > 0.0 {
                look.free += slack.min(multiplier / self.step) * slack;
            } else {
                look.bound += slack.min(0.0).powi(2);
            }
        }
        look
    }

    /// A step of conjugate gradients among free multipliers.
    fn explore(&mut self) {
        self.multiply();
        let curvature = dot(&self.direction, &self.product);
        let whole = dot(&self.slacks, &self.direction) / curvature;
        let room = self.room();
        if whole.is_finite() && whole <= room {
            self.walk(whole);
            let mix = self.free_dot() / curvature;
            for row in 0..self.direction.len() {
                let free = if self.is_free(row) { self.slacks[row] } else { 0.0 };
                self.direction[row] = free - mix * self.direction[row];
            }
        } else {
            self.walk(room);
            self.shift();
        }
    }

    /// Goes along the direction; the slacks follow.
    fn walk(&mut self, length: f64) {
        for row in 0..self.multipliers.len() {
            self.multipliers[row] -= length * self.direction[row];
            self.slacks[row] -= length * self.product[row];
        }
        clip(&mut self.multipliers);
    }

    /// A projected step of the free multipliers, after which directions start anew.
    fn shift(&mut self) {
        for row in 0..self.multipliers.len() {
            if self.is_free(row) {
                self.multipliers[row] -= self.step * self.slacks[row];
            }
        }
        clip(&mut self.multipliers);
        self.slacks = self.program.slacks(&self.multipliers);
        self.turn();
    }

    /// A step of the multipliers at zero that are pulled.
    fn proportion(&mut self) {
        for row in 0..self.direction.len() {
            self.direction[row] = if self.is_free(row) { 0.0 } else { self.slacks[row].min(0.0) };
        }
        self.multiply();
        let whole = dot(&self.slacks, &self.direction) / dot(&self.direction, &self.product);
        self.walk(if whole.is_finite() { whole } else { self.step });
        self.turn();
    }

    /// Downhill among the free multipliers.
    fn turn(&mut self) {
        for row in 0..self.direction.len() {
            self.direction[row] = if self.is_free(row) { self.slacks[row] } else { 0.0 };
        }
    }

    /// How far the direction leads before a multiplier vanishes.
    fn room(&self) -> f64 {
        let mut room = f64::INFINITY;
        for row in 0..self.direction.len() {
            if self.direction[row] > 0.0 {
                room = room.min(self.multipliers[row] / self.direction[row]);
            }
        }
        room
    }

    /// Free slacks times `A A^T` times the direction.
    fn free_dot(&self) -> f64 {
        (0..self.slacks.len()).filter(|&row| self.is_free(row)).map(|row| self.slacks[row] * self.product[row]).sum()
    }

    fn is_free(&self, row: usize) -> bool {
        self.multipliers[row] > 0.0
    }

    fn multiply(&mut self) {
        self.program.push(&self.direction, &mut self.unknowns);
        self.program.open(&self.unknowns, &mut self.product);
    }

    /// Of `A A^T`, by powers of it.
    fn largest_eigenvalue(&mut self) -> f64 {
        let mut eigenvalue = 1.0;
        // alternating and uneven, so that no smooth mode is all of it
        self.direction = (0..self.slacks.len()).map(|row| 1.0 + (row % 7) as f64).collect();
        for _ in 0..POWERS {
            let length = dot(&self.direction, &self.direction).sqrt();
            self.direction.iter_mut().for_each(|value| *value /= length);
            self.multiply();
            eigenvalue = dot(&self.product, &self.product).sqrt();
            std::mem::swap(&mut self.direction, &mut self.product);
        }
        eigenvalue
    }
}

fn dot(one: &[f64], two: &[f64]) -> f64 {
    one.iter().zip(two).map(|(one, two)| one * two).sum()
}
