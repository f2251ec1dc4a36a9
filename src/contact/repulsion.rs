//! Repulsion of short range, as in molecular dynamics: a force that depends on the gap alone.
//!
//! ```text
//! F(gap) = touch (1 - gap/r)^2      0 < gap < r
//!          touch (1 - 2 gap/r)      gap <= 0        zero beyond r
//! ```
//!
//! with `r` the range. The force and its slope are continuous; the slope is steepest, `2 touch / r`, from touch on.

use super::{Contact, ContactForce, candidates};
use crate::geometry::{Ball, Domain};

/// A repulsion with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repulsion {
    /// Force at touch.
    pub touch: f64,
    /// Largest gap at which it acts, in radii of the smaller body.
    pub range: f64,
}

impl Repulsion {
    /// The force at a gap between bodies of which the smaller has this radius.
    pub fn force(&self, gap: f64, radius: f64) -> f64 {
        let part = gap / (self.range * radius);
        self.touch * if part > 0.0 { (1.0 - part).max(0.0).powi(2) } else { 1.0 - 2.0 * part }
    }

    /// The steepest slope of the force, of bodies of which the smaller has this radius.
    pub fn steepest(&self, radius: f64) -> f64 {
        2.0 * self.touch / (self.range * radius)
    }

    /// All forces that act; a body whose weight is infinite feels none.
    pub fn forces<const D: usize>(&self, domain: &Domain<D>, balls: &[Ball<D>], weights: &[f64]) -> Vec<ContactForce<D>> {
        let reach = self.range * balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
        let force = |contact: Contact<D>| ContactForce { contact, force: self.force(contact.gap, contact.smaller_radius(balls)) };
        let mut forces: Vec<_> = candidates(domain, balls, weights, reach).into_iter().map(force).collect();
        forces.retain(|force| force.force > 0.0);
        forces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_the_slope_of_an_energy_without_kinks() {
        let repulsion = Repulsion { touch: 3.0, range: 0.2 };
        let (radius, range) = (0.5, 0.1);
        assert_eq!([repulsion.force(0.0, radius), repulsion.force(range, radius), repulsion.force(2.0 * range, radius)], [3.0, 0.0, 0.0]);
        let slope = |gap: f64| (repulsion.force(gap + 1e-7, radius) - repulsion.force(gap - 1e-7, radius)) / 2e-7;
        // continuous at touch and at the range; steepest from touch on
        assert!((slope(0.0) + repulsion.steepest(radius)).abs() < 1e-3 && slope(range).abs() < 1e-3);
        assert!((slope(-0.03) + repulsion.steepest(radius)).abs() < 1e-5);
        assert!((slope(0.5 * range) + 0.5 * repulsion.steepest(radius)).abs() < 1e-5);
    }
}
