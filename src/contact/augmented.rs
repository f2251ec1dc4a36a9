//! The augmented Lagrangian: Newton's method among unknowns and multipliers, for islands too large for an interior point.
//!
//! From multipliers `z` and a softness `e`, unknowns `x` that minimise `1/2 |x|^2 + e/2 |[z - (A x + c) / e]_+|^2` give the next
//! multipliers `[z - (A x + c) / e]_+`, and so on: this ends at the solution whatever the softness, the sooner the smaller it is, also where
//! constraints repeat each other. The function is convex and made of parabolas: Newton's method with an exact search along its
//! direction finds its minimum in a few steps, each of which factors only the rows that press (Hermans, Themelis and
//! Patrinos 2019, QPALM, doi:10.1109/CDC40024.2019.9030211). Sticky rows press always.

use super::{
    active::{Equations, sharpen},
    program::{Program, clip},
};

/// Softness at the start, and the smallest: with less, rounding of slacks over the softness shows in multipliers.
const SOFTNESS: [f64; 2] = [1e-2, 1e-6];
/// The softness becomes so much less from update to update, so that a few Newton steps suffice for each..
const HARDENING: f64 = 0.3;
/// .. and from this on only if the residual has not become so much less.
const FIRM: f64 = 1e-4;
const PROGRESS: f64 = 0.3;
/// Updates of the multipliers before giving up.
const UPDATES: usize = 40;
/// Newton steps for one update, and for all: an interior point costs as much and does not fail.
const STEPS: [usize; 2] = [50, 120];
/// Halvings in the search for the minimum along a direction.
const HALVINGS: usize = 30;
/// A change of the unknowns, in parts of the residual times the softness, that is none, and one that is rounding.
const STILL: [f64; 2] = [1.0, 1e-13];
/// Residual from which exact equations may lead to the solution at once, and what it must lose before they are tried again.
const NEAR: f64 = 1e-3;
const NEARER: f64 = 0.1;

/// Where the method stands.
pub(super) struct Augmented<'a> {
    program: &'a Program,
    /// The multipliers.
    pub multipliers: Vec<f64>,
    /// Newton steps so far.
    pub steps: usize,
    unknowns: Vec<f64>,
    slacks: Vec<f64>,
    residual: f64,
    softness: f64,
}

impl<'a> Augmented<'a> {
    /// Starts from multipliers.
    pub fn new(program: &'a Program, multipliers: Vec<f64>) -> Self {
        let (unknowns, slacks) = (vec![0.0; program.transposed.m], Vec::new());
        let mut start = Self { program, multipliers, steps: 0, unknowns, slacks, residual: f64::INFINITY, softness: SOFTNESS[0] };
        start.meet_multipliers();
        start
    }

    /// Goes on until the program is solved to a tolerance, if it can be.
    pub fn run(&mut self, tolerance: f64) {
        let mut sharpened_at = NEAR / NEARER;
        for _ in 0..UPDATES {
            if !self.minimise() {
                return;
            }
            self.update();
            let earlier = std::mem::replace(&mut self.residual, self.program.residual(&self.multipliers));
            if self.residual < NEARER * sharpened_at {
                sharpened_at = self.residual;
                self.multipliers = sharpen(self.program, &self.multipliers);
            }
            self.meet_multipliers();
            if self.program.solved(&self.multipliers, tolerance) || self.steps >= STEPS[1] {
                return;
            }
            if self.residual > PROGRESS * earlier || self.softness > FIRM {
                self.softness = SOFTNESS[1].max(HARDENING * self.softness);
            }
        }
    }

    /// The unknowns that minimise the function, from where they are; whether they were found.
    fn minimise(&mut self) -> bool {
        let small = (STILL[0] * self.residual.min(1.0) * self.softness).max(STILL[1]);
        let mut earlier = Vec::new();
        for _ in 0..STEPS[0] {
            let pressing: Vec<usize> = (0..self.slacks.len()).filter(|&row| self.presses(row, self.slacks[row])).collect();
            if pressing == earlier {
                return true;
            }
            let Some((unknowns, slacks)) = self.newton(&pressing) else { return false };
            self.steps += 1;
            let (move_x, move_s) = (difference(&unknowns, &self.unknowns), difference(&slacks, &self.slacks));
            let length = self.search(&move_x, &move_s);
            self.unknowns.iter_mut().zip(&move_x).for_each(|(unknown, change)| *unknown += length * change);
            self.slacks.iter_mut().zip(&move_s).for_each(|(slack, change)| *slack += length * change);
            if length * dot(&move_x, &move_x).sqrt() <= small {
                return true;
            }
            earlier = if length == 1.0 { pressing } else { Vec::new() };
        }
        false
    }

    /// Unknowns and slacks at the minimum if just these rows press: `x = A^T y`, `s = e (z - y)` in each of them.
    fn newton(&self, pressing: &[usize]) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut equations = Equations::new(self.program, pressing, self.softness)?;
        let mut forces = vec![0.0; self.slacks.len()];
        let (mut unknowns, mut slacks) = (vec![0.0; self.unknowns.len()], self.program.offsets.clone());
        // the second time takes the rounding of the first away
        for _ in 0..2 {
            let missing = |&row: &usize| slacks[row] - self.softness * (self.multipliers[row] - forces[row]);
            let changes = equations.solve(pressing.iter().map(missing).collect::<Vec<_>>().into_iter());
            pressing.iter().zip(changes).for_each(|(&row, change)| forces[row] += change);
            self.program.push(&forces, &mut unknowns);
            self.program.open(&unknowns, &mut slacks);
            slacks.iter_mut().zip(&self.program.offsets).for_each(|(slack, offset)| *slack += offset);
        }
        Some((unknowns, slacks))
    }

    /// How far along a direction the minimum lies.
    fn search(&self, move_x: &[f64], move_s: &[f64]) -> f64 {
        let (start, square) = (dot(&self.unknowns, move_x), dot(move_x, move_x));
        let slope = |length: f64| {
            let pressed = |row: usize| {
                let slack = self.slacks[row] + length * move_s[row];
                if self.presses(row, slack) { (self.multipliers[row] - slack / self.softness) * move_s[row] } else { 0.0 }
            };
            start + length * square - (0..move_s.len()).map(pressed).sum::<f64>()
        };
        if slope(1.0) <= STILL[1] * slope(0.0).abs() {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            *(if slope(middle) > 0.0 { &mut high } else { &mut low }) = middle;
        }
        0.5 * (low + high)
    }

    fn presses(&self, row: usize, slack: f64) -> bool {
        slack < self.softness * self.multipliers[row]
    }

    /// The next multipliers.
    fn update(&mut self) {
        let rows = self.multipliers.iter_mut().zip(&self.slacks);
        rows.for_each(|(multiplier, slack)| *multiplier -= slack / self.softness);
        clip(&mut self.multipliers);
    }

    /// Unknowns and slacks of the multipliers.
    fn meet_multipliers(&mut self) {
        self.program.push(&self.multipliers, &mut self.unknowns);
        self.slacks = self.program.slacks(&self.multipliers);
    }
}

fn difference(one: &[f64], two: &[f64]) -> Vec<f64> {
    one.iter().zip(two).map(|(one, two)| one - two).collect()
}

fn dot(one: &[f64], two: &[f64]) -> f64 {
    one.iter().zip(two).map(|(one, two)| one * two).sum()
}
