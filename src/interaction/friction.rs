//! Coulomb friction at contacts.

use super::{ContactLaw, Interaction};
use crate::geometry::Ball;

/// Coulomb friction at inelastic contacts of bodies with each other and with walls ([`contact`](crate::contact)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Largest tangential force over the normal force, the same at all contacts; 0 of surfaces that are rough alone.
    pub coefficient: f64,
    /// Gap at which bodies in a fluid touch, over the mean of their radii; walls are smooth, and touched at half of it.
    pub roughness: f64,
}

impl Friction {
    /// Balls that touch where bodies with their roughness do.
    pub fn touching<const D: usize>(&self, balls: &[Ball<D>]) -> Vec<Ball<D>> {
        balls.iter().map(|ball| Ball { radius: ball.radius * (1.0 + 0.5 * self.roughness), ..*ball }).collect()
    }
}

impl<const D: usize> Interaction<D> for Friction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn describe(&self) -> String {
        let touching = if self.roughness > 0.0 { format!("; bodies touch at a gap of {} radii", self.roughness) } else { String::new() };
        if self.coefficient == 0.0 {
            return format!("none{touching}");
        }
        format!("Coulomb's exact law with coefficient {}, at the level of velocities{touching}", self.coefficient)
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        ContactLaw { friction: Some(*self), ..ContactLaw::default() }
    }
}
