//! The interior point on sparse normal equations: Newton's method along the central path, where `s z` is the same in each constraint.
//!
//! Unknowns `x = A^T z`, slacks `s = A x + c + d (z - z_before)` and multipliers `z`, both positive, follow the path to `s z = 0` by
//! a prediction, its correction (Mehrotra 1992, doi:10.1137/0802028), and further corrections of the products that are far from the
//! others (Gondzio 1996, doi:10.1007/BF00249643). An iteration factors `I + A^T Z / (S + d Z) A` once and solves with it two to four
//! times. The damping `d`, which is gone when multipliers no longer change, bounds the weights and lets constraints repeat
//! each other (Friedlander and Orban 2012, doi:10.1007/s12532-012-0035-2). How many iterations it takes hardly depends
//! on how many constraints there are, nor on how far from the guess they press. Ranks that share a program share its factors.

use super::{factors::Factors, program::Program};

/// Products of slacks and multipliers at the start.
const START: f64 = 0.1;
/// `d`.
const DAMPING: f64 = 1e-10;
/// Part of the way to the nearest bound that is gone.
const PART: f64 = 0.995;
/// Corrections in an iteration besides the first, how much longer than the last step each is planned, and the part of that it must gain.
const CORRECTIONS: usize = 2;
const LONGER: f64 = 0.3;
const GAIN: f64 = 0.1;
/// Products between these, over the one aimed at, are not corrected.
const BAND: [f64; 2] = [0.03, 30.0];
/// Steps shorter than this lead nowhere.
const SHORTEST: f64 = 1e-5;

/// Where the method stands.
pub struct InteriorPoint<'a> {
    /// What it solves.
    pub program: &'a Program<'a>,
    /// The multipliers, all positive.
    pub multipliers: Vec<f64>,
    slacks: Vec<f64>,
    unknowns: Vec<f64>,
    /// `A x + c`.
    openings: Vec<f64>,
    /// `x - A^T z`.
    drift: Vec<f64>,
    /// `s + d z`.
    damped: Vec<f64>,
}

/// A change of all that the method follows.
struct Direction {
    unknowns: Vec<f64>,
    slacks: Vec<f64>,
    multipliers: Vec<f64>,
}

/// How far from the solution.
#[derive(Debug, Clone, Copy)]
pub struct Distance {
    /// The most that a constraint is violated.
    pub violation: f64,
    /// The work of multipliers on slacks, as a part of all their work if that is more than 1.
    pub work: f64,
}

impl<'a> InteriorPoint<'a> {
    /// Starts near a guess: where the path would be if slacks differed from multipliers by what they do there.
    pub fn new(program: &'a Program<'a>, guess: &[f64]) -> Self {
        let at_guess = program.slacks(guess);
        let slack = |(slack, multiplier): (&f64, &f64)| {
            let half = 0.5 * (slack - multiplier);
            let root = (half * half + START).sqrt();
            if half > 0.0 { root + half } else { START / (root - half) }
        };
        let slacks: Vec<f64> = at_guess.iter().zip(guess).map(slack).collect();
        let multipliers = slacks.iter().map(|slack| START / slack).collect();
        let (unknowns, drift, openings) = (vec![0.0; program.transposed.m], vec![0.0; program.transposed.m], vec![0.0; slacks.len()]);
        let mut point = Self { program, multipliers, damped: slacks.clone(), slacks, unknowns, openings, drift };
        program.apply_transpose(&point.multipliers, &mut point.unknowns);
        point.measure();
        point
    }

    /// How far from the solution this is.
    pub fn distance(&self) -> Distance {
        let least = self.openings.iter().fold(0.0, |least: f64, opening| least.min(*opening));
        let work = -self.program.dot(&self.program.offsets, &self.multipliers);
        let idle = self.program.dot(&self.openings, &self.multipliers).abs();
        Distance { violation: self.program.max(-least), work: idle / work.max(1.0) }
    }

    /// The mean product of a slack and a multiplier.
    fn mean(&self) -> f64 {
        self.program.dot(&self.slacks, &self.multipliers) / self.program.count()
    }

    /// The multipliers without those that are less than their slacks.
    pub fn pressing(&self) -> Vec<f64> {
        let pairs = self.multipliers.iter().zip(&self.slacks);
        pairs.map(|(&multiplier, &slack)| if multiplier > slack { multiplier } else { 0.0 }).collect()
    }

    /// One iteration; whether it led anywhere.
    pub fn step(&mut self, factors: &mut Factors) -> bool {
        let weights: Vec<f64> = self.multipliers.iter().zip(&self.damped).map(|(multiplier, damped)| multiplier / damped).collect();
        factors.factor(&weights);
        let mean = self.mean();
        let products: Vec<f64> = self.slacks.iter().zip(&self.multipliers).map(|(slack, multiplier)| slack * multiplier).collect();
        let predicted = self.direction(factors, &products, true);
        let aim = mean * (self.mean_after(&predicted, self.room(&predicted).min(1.0)) / mean).powi(4);
        let mixed = products.iter().zip(predicted.slacks.iter().zip(&predicted.multipliers));
        let products: Vec<f64> = mixed.map(|(product, (slack, multiplier))| product + slack * multiplier - aim).collect();
        let first = self.direction(factors, &products, true);
        let (direction, room) = self.corrected(factors, first, aim);
        let length = (PART * room).min(1.0);
        self.walk(&direction, length);
        self.measure();
        let lost = self.multipliers.iter().chain(&self.slacks).any(|value| !value.is_finite());
        !self.program.any(lost) && length > SHORTEST
    }

    /// The same direction or a longer one, and how far it leads at most.
    fn corrected(&self, factors: &mut Factors, first: Direction, aim: f64) -> (Direction, f64) {
        let mut room = self.room(&first);
        let mut best = first;
        for _ in 0..CORRECTIONS {
            if room >= 1.0 {
                break;
            }
            let planned = (room + LONGER).min(1.0);
            let excess: Vec<f64> = self.products_after(&best, planned).map(|product| excess(product, aim)).collect();
            let mut trial = self.direction(factors, &excess, false);
            trial.add(&best);
            let trial_room = self.room(&trial);
            if trial_room < room + GAIN * LONGER {
                break;
            }
            (best, room) = (trial, trial_room);
        }
        (best, room)
    }

    /// The change that takes products away from the products of slacks and multipliers, and, if asked, what is wrong with slacks and unknowns.
    fn direction(&self, factors: &mut Factors, products: &[f64], whole: bool) -> Direction {
        let mut slacks: Vec<f64> = if whole {
            self.openings.iter().zip(&self.slacks).map(|(opening, slack)| opening - slack).collect()
        } else {
            vec![0.0; products.len()]
        };
        let push = |row: usize, slack: f64| -(products[row] + self.multipliers[row] * slack) / self.damped[row];
        let mut multipliers: Vec<f64> = slacks.iter().enumerate().map(|(row, &slack)| push(row, slack)).collect();
        let mut unknowns = vec![0.0; self.unknowns.len()];
        self.program.apply_transpose(&multipliers, &mut unknowns);
        if whole {
            unknowns.iter_mut().zip(&self.drift).for_each(|(unknown, drift)| *unknown -= drift);
        }
        factors.solve(&mut unknowns);
        self.program.apply(&unknowns, &mut multipliers);
        for (row, (slack, multiplier)) in slacks.iter_mut().zip(&mut multipliers).enumerate() {
            *slack += *multiplier;
            *multiplier = push(row, *slack);
            *slack += DAMPING * *multiplier;
        }
        Direction { unknowns, slacks, multipliers }
    }

    /// How far a direction leads before a slack or a multiplier vanishes.
    fn room(&self, direction: &Direction) -> f64 {
        let room = |values: &[f64], changes: &[f64]| {
            let falling = values.iter().zip(changes).filter(|(_, change)| **change < 0.0);
            falling.map(|(value, change)| -value / change).fold(f64::INFINITY, f64::min)
        };
        let both = room(&self.slacks, &direction.slacks).min(room(&self.multipliers, &direction.multipliers));
        -self.program.max(-both)
    }

    fn products_after(&self, direction: &Direction, length: f64) -> impl Iterator<Item = f64> {
        let slacks = self.slacks.iter().zip(&direction.slacks).map(move |(slack, change)| slack + length * change);
        let multipliers = self.multipliers.iter().zip(&direction.multipliers).map(move |(multiplier, change)| multiplier + length * change);
        slacks.zip(multipliers).map(|(slack, multiplier)| slack * multiplier)
    }

    fn mean_after(&self, direction: &Direction, length: f64) -> f64 {
        self.program.sum(self.products_after(direction, length)) / self.program.count()
    }

    fn walk(&mut self, direction: &Direction, length: f64) {
        let walk =
            |values: &mut [f64], changes: &[f64]| values.iter_mut().zip(changes).for_each(|(value, change)| *value += length * change);
        walk(&mut self.unknowns, &direction.unknowns);
        walk(&mut self.slacks, &direction.slacks);
        walk(&mut self.multipliers, &direction.multipliers);
    }

    fn measure(&mut self) {
        self.program.apply(&self.unknowns, &mut self.openings);
        self.openings.iter_mut().zip(&self.program.offsets).for_each(|(opening, offset)| *opening += offset);
        self.program.apply_transpose(&self.multipliers, &mut self.drift);
        self.drift.iter_mut().zip(&self.unknowns).for_each(|(drift, unknown)| *drift = unknown - *drift);
        let pairs = self.slacks.iter().zip(&self.multipliers);
        self.damped.iter_mut().zip(pairs).for_each(|(damped, (slack, multiplier))| *damped = slack + DAMPING * multiplier);
    }
}

impl Direction {
    fn add(&mut self, other: &Self) {
        let add = |values: &mut [f64], others: &[f64]| values.iter_mut().zip(others).for_each(|(value, other)| *value += other);
        add(&mut self.unknowns, &other.unknowns);
        add(&mut self.slacks, &other.slacks);
        add(&mut self.multipliers, &other.multipliers);
    }
}

/// By how much a product misses the band around what is aimed at, but no more than the width of the band.
fn excess(product: f64, aim: f64) -> f64 {
    let [low, high] = BAND.map(|part| part * aim);
    (product - product.clamp(low, high)).clamp(-high, high)
}
