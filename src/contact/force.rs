//! Contact forces, and what they add up to.

use nalgebra::{SMatrix, SVector};

use super::Contact;
use crate::body::{RigidFunctional, Row};

/// A contact and the force that keeps it open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce<const D: usize> {
    /// The contact, as it was before the step.
    pub contact: Contact<D>,
    /// Force on the partner along the normal, and on the body against it; negative only where a contact may pull.
    pub force: f64,
}

impl<const D: usize> Contact<D> {
    /// The row by which the gap closes in a step of this length, and no sooner.
    pub fn row(&self, step: f64) -> Row<D> {
        let side = |direction| RigidFunctional { direction, turn: SMatrix::zeros() };
        let partner = self.other().map(|other| (other, side(self.normal)));
        let ends = [(self.body, side(-self.normal))].into_iter().chain(partner).collect();
        Row::new(ends, -self.gap / step - self.normal.dot(&self.sliding), 0.0)
    }
}

/// The force on each of so many bodies by contact forces, which are opposite on the two bodies of a contact.
pub fn pushes<const D: usize>(bodies: usize, forces: impl IntoIterator<Item = ContactForce<D>>) -> Vec<SVector<f64, D>> {
    let mut pushes = vec![SVector::zeros(); bodies];
    for ContactForce { contact, force } in forces {
        pushes[contact.body] -= contact.normal * force;
        if let Some(other) = contact.other() {
            pushes[other] += contact.normal * force;
        }
    }
    pushes
}
