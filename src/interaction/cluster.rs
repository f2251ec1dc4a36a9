//! Balls that share one motion, and which of them are tied to each other.

use std::ops::Range;

use nalgebra::SVector;

use crate::geometry::Ball;

/// Balls that share one motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster<const D: usize> {
    /// The balls, all of one radius.
    pub bodies: Range<usize>,
    /// Their centres at the start, from their mean.
    pub offsets: Vec<SVector<f64, D>>,
    /// Which ball of those before it each is tied to; the first one to itself. Counted from the first.
    tied_to: Vec<usize>,
    /// Radius of its balls.
    pub radius: f64,
}

impl<const D: usize> Cluster<D> {
    /// The cluster of balls numbered from `first`, where they are at the start.
    ///
    /// # Panics
    /// If there is none.
    pub fn new(first: usize, balls: &[Ball<D>]) -> Cluster<D> {
        let middle = balls.iter().map(|ball| ball.center).sum::<SVector<f64, D>>() / balls.len() as f64;
        let offsets: Vec<SVector<f64, D>> = balls.iter().map(|ball| ball.center - middle).collect();
        let tied_to = (0..offsets.len()).map(|ball| nearest(&offsets[..ball], &offsets[ball])).collect();
        Cluster { bodies: first..first + balls.len(), offsets, tied_to, radius: balls[0].radius }
    }

    /// Distance of two of its balls; nothing if one is none of them.
    pub fn distance(&self, balls: [usize; 2]) -> Option<f64> {
        let offset = |ball: usize| self.bodies.contains(&ball).then(|| self.offsets[ball - self.bodies.start]);
        Some((offset(balls[0])? - offset(balls[1])?).norm())
    }

    /// The balls that each ball but the first is tied to.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.bodies.clone().zip(&self.tied_to).skip(1).map(|(ball, to)| [ball, self.bodies.start + to])
    }
}

/// The place of the nearest of some; 0 if there are none.
fn nearest<const D: usize>(places: &[SVector<f64, D>], to: &SVector<f64, D>) -> usize {
    let distance = |&place: &usize| (places[place] - to).norm();
    (0..places.len()).min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap_or(0)
}
