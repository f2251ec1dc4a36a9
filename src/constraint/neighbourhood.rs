//! The bodies of all ranks, and which of them are near each other: looked for once, for all that asks.

use crate::geometry::{Ball, Domain, Pair, WallPair, near_pairs, near_walls};

/// Largest gap at which films are known, in radii of the smaller body.
pub const LUBRICATION_REACH: f64 = 1.25;

/// Gap, over the mean radius of the two, below which bodies are a near pair in the approximate inverse.
pub const PAIR_REACH: f64 = 1.0;

/// Bodies in their places, with what is within reach of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbourhood<const D: usize> {
    /// The bodies, with their centres in the box.
    pub balls: Vec<Ball<D>>,
    /// Order of the modes of each.
    pub orders: Vec<usize>,
    /// Pairs of bodies within reach.
    pub pairs: Vec<Pair<D>>,
    /// Bodies within reach of a wall.
    pub walls: Vec<WallPair<D>>,
}

impl<const D: usize> Neighbourhood<D> {
    /// Bodies with their centres in the box; near is what is less than `reach` away.
    pub fn new(domain: &Domain<D>, balls: Vec<Ball<D>>, orders: Vec<usize>, reach: f64) -> Neighbourhood<D> {
        let (pairs, walls) = (near_pairs(domain, &balls, reach), near_walls(domain, &balls, reach));
        Neighbourhood { balls, orders, pairs, walls }
    }

    /// A reach beyond which neither films nor the approximate inverse know of a neighbour.
    pub fn reach(balls: &[Ball<D>]) -> f64 {
        LUBRICATION_REACH.max(PAIR_REACH) * balls.iter().map(|ball| ball.radius).fold(0.0, f64::max)
    }

    /// Whether a pair is one whose bodies feel each other in the approximate inverse.
    pub fn near(&self, pair: &Pair<D>) -> bool {
        pair.gap < PAIR_REACH * 0.5 * (self.balls[pair.first].radius + self.balls[pair.second].radius)
    }
}
