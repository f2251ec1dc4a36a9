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
    /// Force of friction on the partner, across the normal, and on the body against it.
    pub tangential: SVector<f64, D>,
    /// In a flow the couple against rolling and twisting on the partner, a skew matrix, and on the body against it.
    pub couple: SMatrix<f64, D, D>,
}

impl<const D: usize> ContactForce<D> {
    /// A force along the normal alone.
    pub fn normal(contact: Contact<D>, force: f64) -> ContactForce<D> {
        ContactForce { contact, force, tangential: SVector::zeros(), couple: SMatrix::zeros() }
    }

    /// The force on the partner.
    pub fn whole(&self) -> SVector<f64, D> {
        self.contact.normal * self.force + self.tangential
    }

    /// What the couple adds to the stress times volume, as a given torque on the body does: nothing between bodies, of which each has the opposite one.
    pub fn stress_of_couple(&self) -> SMatrix<f64, D, D> {
        if self.contact.other().is_some() { SMatrix::zeros() } else { self.couple * 0.5 }
    }
}

impl<const D: usize> Contact<D> {
    /// The row by which the gap closes in a step of this length, and no sooner, of a contact that does not pull.
    pub fn row(&self, step: f64) -> Row<D> {
        let side = |direction| RigidFunctional { direction, turn: SMatrix::zeros() };
        let partner = self.other().map(|other| (other, side(self.normal)));
        let ends = [(self.body, side(-self.normal))].into_iter().chain(partner).collect();
        Row { least: 0.0, ..Row::new(ends, -self.gap / step - self.normal.dot(&self.sliding), 0.0) }
    }
}

/// The force on each of so many bodies by contact forces, which are opposite on the two bodies of a contact.
pub fn pushes<const D: usize>(bodies: usize, forces: impl IntoIterator<Item = ContactForce<D>>) -> Vec<SVector<f64, D>> {
    let mut pushes = vec![SVector::zeros(); bodies];
    for force in forces {
        let push = force.whole();
        pushes[force.contact.body] -= push;
        if let Some(other) = force.contact.other() {
            pushes[other] += push;
        }
    }
    pushes
}
