//! Coulomb friction at contacts.

use super::{ContactLaw, Friction, Interaction, UnequalFriction};
use crate::friction::FrictionLaw;

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
        let FrictionLaw { coefficient, rolling, twisting, critical_load, convex } = self.surfaces.largest();
        let turns = [(rolling, "rolling"), (twisting, "twisting")].into_iter().filter(|(number, _)| *number > 0.0);
        let more: String = turns.map(|(number, name)| format!(", of {name} up to {number}")).collect();
        let load = if critical_load > 0.0 { format!(", above normal forces of {critical_load}") } else { String::new() };
        let law = if convex { "convex" } else { "exact" };
        format!(
            "Coulomb's {law} law at the level of velocities, with coefficients up to {coefficient}{more}{load}: of a contact the smaller ones of its surfaces"
        )
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        ContactLaw { friction: Some(self.friction), surfaces: Some(&self.surfaces), ..ContactLaw::default() }
    }
}
