//! The bodies of all ranks, and which of them are near those of this rank: looked for once, for all that asks.

use nalgebra::SVector;

use crate::geometry::{Ball, Bounds, Domain, Pair, WallPair, near_pairs, near_walls};

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
    /// Pairs of bodies within reach, all of those with a body of this rank among them.
    pub pairs: Vec<Pair<D>>,
    /// Bodies within reach of a wall.
    pub walls: Vec<WallPair<D>>,
}

impl<const D: usize> Neighbourhood<D> {
    /// Bodies with their centres in the box, of which some, around a middle, are this rank's; near is what is less than `reach` away.
    pub fn new(
        domain: &Domain<D>,
        balls: Vec<Ball<D>>,
        orders: Vec<usize>,
        reach: f64,
        own: &[usize],
        middle: &SVector<f64, D>,
    ) -> Neighbourhood<D> {
        let within_reach = within_reach(domain, &balls, reach, own, middle);
        let few: Vec<Ball<D>> = within_reach.iter().map(|&body| balls[body]).collect();
        let mut pairs = near_pairs(domain, &few, reach);
        pairs.iter_mut().for_each(|pair| (pair.first, pair.second) = (within_reach[pair.first], within_reach[pair.second]));
        let walls = near_walls(domain, &balls, reach);
        Neighbourhood { balls, orders, pairs, walls }
    }

    /// Bodies of one rank.
    pub fn alone(domain: &Domain<D>, balls: Vec<Ball<D>>, orders: Vec<usize>, reach: f64) -> Neighbourhood<D> {
        let all: Vec<usize> = (0..balls.len()).collect();
        Neighbourhood::new(domain, balls, orders, reach, &all, &(domain.size * 0.5))
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

/// Bodies that may be less than `reach` away from an own one, ascending.
fn within_reach<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64, own: &[usize], middle: &SVector<f64, D>) -> Vec<usize> {
    if own.len() == balls.len() {
        return own.to_vec();
    }
    let bounds = |body: usize| Bounds::of(domain, &Ball { radius: balls[body].radius + 0.5 * reach, ..balls[body] }, middle);
    let around = Bounds::around(&own.iter().map(|&body| bounds(body)).collect::<Vec<_>>());
    (0..balls.len()).filter(|&body| bounds(body).meets(&around, domain)).collect()
}
