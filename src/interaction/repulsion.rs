//! Repulsion of short range, as in molecular dynamics: a force that depends on the gap alone.
//!
//! ```text
//! F(gap) = touch (1 - gap/r)^2      0 < gap < r
//!          touch (1 - 2 gap/r)      gap <= 0        zero beyond r
//! ```
//!
//! with `r` the range. The force and its slope are continuous; the slope is steepest, `2 touch / r`, from touch on.

use super::{Arrangement, ContactLaw, Forces, Interaction, Touch};
use crate::contact::{Contact, ContactForce};

/// Overlap, in radii, at which it is too soft.
const SOFT_OVERLAP: f64 = 0.02;

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
}

impl<const D: usize> Interaction<D> for Repulsion {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn describe(&self) -> String {
        format!("repulsion of force {:.3e} at touch within {} radii", self.touch, self.range)
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        Touch::Soft { overlap: SOFT_OVERLAP, remedy: "raise contact.stiffness or contact.range" }.into()
    }

    fn steepest(&self, radius: f64) -> f64 {
        2.0 * self.touch / (self.range * radius)
    }

    fn reach(&self, largest_radius: f64) -> f64 {
        self.range * largest_radius
    }

    fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let balls = arrangement.balls;
        let reach = Interaction::<D>::reach(self, balls.iter().map(|ball| ball.radius).fold(0.0, f64::max));
        let force = |contact: Contact<D>| ContactForce::normal(contact, self.force(contact.gap, contact.smaller_radius(balls)));
        let mut contacts: Vec<_> = arrangement.near(reach).into_iter().map(force).collect();
        contacts.retain(|force| force.force > 0.0);
        Forces { contacts, ..Forces::default() }
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
        assert!((slope(0.0) + Interaction::<2>::steepest(&repulsion, radius)).abs() < 1e-3 && slope(range).abs() < 1e-3);
        assert!((slope(-0.03) + Interaction::<2>::steepest(&repulsion, radius)).abs() < 1e-5);
        assert!((slope(0.5 * range) + 0.5 * Interaction::<2>::steepest(&repulsion, radius)).abs() < 1e-5);
    }
}
