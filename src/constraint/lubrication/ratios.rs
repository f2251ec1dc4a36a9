//! Ratios of radii at which resistances are computed; in each octave a polynomial of their logarithm interpolates between them.

use std::f64::consts::PI;

use super::pair::Lift;
use crate::linalg::{ROUNDING, lagrange};

/// Nodes of an octave, both of its ends among them.
const NODES: usize = 9;

/// Both bodies move in the first octave, in those from this ratio on the smaller one alone.
pub const LARGEST_BALANCED: f64 = 2.0;

/// The last octave, whose end larger ratios count as.
const LAST_OCTAVE: f64 = 9.0;

/// A ratio of radii, and how relative motions of the pair are lifted to motions of both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct RatioNode {
    octave: usize,
    number: usize,
    /// How motions are lifted.
    pub lift: Lift,
}

impl RatioNode {
    /// The largest ratio of balanced motions, with the smaller body moving alone.
    pub const FIRST: RatioNode = RatioNode { octave: 1, number: 0, lift: Lift::First };

    /// The ratio.
    pub fn ratio(self) -> f64 {
        (self.octave as f64 + place(self.number)).exp2()
    }
}

/// Part of the octave below a node: extrema of a Chebyshev polynomial.
fn place(number: usize) -> f64 {
    0.5 - 0.5 * (PI * number as f64 / (NODES - 1) as f64).cos()
}

/// The nodes of the octave of a ratio, at least 1, and their weights.
pub fn nodes(ratio: f64) -> Vec<(RatioNode, f64)> {
    let (lift, octaves) = (lift(ratio), ratio.log2().clamp(0.0, LAST_OCTAVE + 1.0));
    let octave = if lift == Lift::Balanced { 0.0 } else { octaves.floor().clamp(1.0, LAST_OCTAVE) };
    let weights: [f64; NODES] = lagrange(&std::array::from_fn(place), octaves - octave);
    let node = |(number, weight)| (RatioNode { octave: octave as usize, number, lift }, weight);
    weights.into_iter().enumerate().map(node).filter(|(_, weight)| weight.abs() > ROUNDING).collect()
}

/// How relative motions of bodies of a ratio are lifted.
pub fn lift(ratio: f64) -> Lift {
    if ratio > LARGEST_BALANCED { Lift::First } else { Lift::Balanced }
}
