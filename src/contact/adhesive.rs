//! Contacts that hold on to what they touch.

use super::{Identity, Partner, bodies_of};

/// A contact that sticks, and its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveContact<const D: usize> {
    /// The body.
    pub body: usize,
    /// What it sticks to.
    pub partner: Partner,
    /// Which image of the partner.
    pub image: [i32; D],
    /// Impulse with which it was pressed, as a negative number, over a unit: viscosity, or the reduced mass of the two.
    pub gamma: f64,
}

impl<const D: usize> AdhesiveContact<D> {
    /// What tells its contact from all others.
    pub fn identity(&self) -> Identity<D> {
        (self.body, self.partner, self.image)
    }

    /// The bodies that it concerns.
    pub fn bodies(&self) -> impl Iterator<Item = usize> {
        bodies_of(self.identity())
    }
}

impl<const D: usize> From<(Identity<D>, f64)> for AdhesiveContact<D> {
    fn from(((body, partner, image), gamma): (Identity<D>, f64)) -> AdhesiveContact<D> {
        AdhesiveContact { body, partner, image, gamma }
    }
}
