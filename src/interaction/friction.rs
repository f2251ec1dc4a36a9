//! Coulomb friction at contacts of dry bodies.

use super::{ContactLaw, Interaction};

/// Coulomb friction at inelastic contacts of dry bodies, with each other and with walls ([`contact`](crate::contact)).
#[derive(Debug, Clone, Copy)]
pub struct Friction {
    /// Largest tangential force over the normal force, the same at all contacts; positive.
    pub coefficient: f64,
}

impl<const D: usize> Interaction<D> for Friction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn describe(&self) -> String {
        format!("Coulomb's exact law with coefficient {}, at the level of velocities", self.coefficient)
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        ContactLaw { friction: self.coefficient, ..ContactLaw::default() }
    }
}
