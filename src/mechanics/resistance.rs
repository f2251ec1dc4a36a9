//! What it takes to move bodies, each as if it were alone but for its films.

use crate::{contact::Contact, friction::NetworkResistance};
use crate::{
    setup::{Setup, SuspendedBody},
    system::{assembly::Assembly, fixed_operators::FixedOperators, network_resistance::network_resistance},
};

/// What bodies resist, for the projection of velocities on those that keep contacts.
pub struct Resistance<'a, const D: usize> {
    setup: &'a Setup<D>,
    /// What knows bodies with their modes and films; none on fitted meshes.
    fixed: Option<&'a FixedOperators<D>>,
    /// Bodies where they were solved last.
    assembly: Option<&'a Assembly<D>>,
    /// The force in the equations of a step that a unit of the mean force of contacts over it is: with inertia contacts give impulses.
    pub of_impulse: f64,
}

impl<'a, const D: usize> Resistance<'a, D> {
    /// Of bodies in unbounded fluid, without films.
    pub fn unbounded(setup: &'a Setup<D>) -> Self {
        Resistance { setup, fixed: None, assembly: None, of_impulse: 1.0 }
    }

    /// Of bodies with modes and films.
    pub fn of_modes(fixed: &'a FixedOperators<D>, assembly: Option<&'a Assembly<D>>, of_impulse: f64) -> Self {
        Resistance { setup: &fixed.setup, fixed: Some(fixed), assembly, of_impulse }
    }

    /// Force that gives each body a unit velocity in unbounded fluid; infinite for a body whose motion is given.
    pub fn of_bodies(&self) -> Vec<f64> {
        let alone = |body: &SuspendedBody<D>| if body.body.free() { self.setup.resistance(&body.body.ball) } else { f64::INFINITY };
        self.fixed.map_or_else(|| self.setup.bodies.iter().map(alone).collect(), FixedOperators::resistances)
    }

    /// What bodies with modes resist as a network, where they were solved last. Collective.
    pub fn of_network(&self) -> NetworkResistance<D> {
        let of = |fixed| network_resistance(fixed, self.assembly, self.of_impulse);
        self.fixed.map_or_else(NetworkResistance::default, of)
    }

    /// What interactions resist the approach of a contact by, force over speed, besides the flow that is resolved; for the mean force of contacts over a step.
    pub fn of_film(&self, contact: &Contact<D>) -> f64 {
        self.fixed.map_or(0.0, |fixed| fixed.film_resistance(contact)) / self.of_impulse
    }
}
