//! The problem of a step: bodies, weights, the velocities wanted, and the step itself.

use nalgebra::SVector;

use super::Contact;
use crate::geometry::{Ball, Domain};

/// Bodies that want to move for one step.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// The bodies, where they are before the step.
    pub balls: &'a [Ball<D>],
    /// Force per unit of velocity that a body is turned aside by (mass over step in a dry run, a resistance in
    /// Stokes flow): positive, and infinite for a body whose velocity is given.
    pub weights: &'a [f64],
    /// Velocities wanted.
    pub velocities: &'a [SVector<f64, D>],
    /// Length of the step.
    pub step: f64,
}

impl<const D: usize> Problem<'_, D> {
    /// Whether a body can be turned aside.
    pub(super) fn gives_way(&self, body: usize) -> bool {
        self.weights[body].is_finite()
    }

    /// Linearised gap after the step.
    pub(super) fn gap_after(&self, contact: &Contact<D>, velocities: &[SVector<f64, D>]) -> f64 {
        contact.gap + self.step * contact.opening(velocities)
    }

    /// How easily a contact opens: the sum of the inverse weights of its bodies.
    pub(super) fn mobility(&self, contact: &Contact<D>) -> f64 {
        1.0 / self.weights[contact.body] + contact.other().map_or(0.0, |other| 1.0 / self.weights[other])
    }

    /// The velocities that contact forces turn the wanted ones into.
    pub(super) fn turned_aside(&self, contacts: &[Contact<D>], forces: &[f64]) -> Vec<SVector<f64, D>> {
        let mut pushes = vec![SVector::zeros(); self.balls.len()];
        for (contact, &force) in contacts.iter().zip(forces) {
            pushes[contact.body] -= contact.normal * force;
            if let Some(other) = contact.other() {
                pushes[other] += contact.normal * force;
            }
        }
        (0..pushes.len()).map(|body| self.velocities[body] + pushes[body] / self.weights[body]).collect()
    }
}
