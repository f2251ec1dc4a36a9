//! Coulomb friction at contacts.

use super::{ContactLaw, Friction, Interaction, UnequalFriction};

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

impl<const D: usize> Interaction<D> for UnequalFriction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn describe(&self) -> String {
        format!(
            "Coulomb's exact law at the level of velocities, with coefficients up to {}: of a contact that of its smoother surface",
            self.friction.coefficient
        )
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        ContactLaw { friction: Some(self.friction), surfaces: Some(&self.surfaces), ..ContactLaw::default() }
    }
}
