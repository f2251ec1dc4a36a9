//! Tangential forces, kept from step to step as vectors in space: frames of contacts turn.

use nalgebra::SVector;

use crate::contact::{Identity, Partner, bodies_of, pack, packed_length, unpack};

/// The tangential force of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentialForce<const D: usize> {
    /// The body.
    pub body: usize,
    /// What it touches.
    pub partner: Partner,
    /// Which image of the partner.
    pub image: [i32; D],
    /// Force on the partner, and on the body against it.
    pub force: SVector<f64, D>,
}

impl<const D: usize> TangentialForce<D> {
    /// How many numbers [`pack`](Self::pack) makes.
    pub const LENGTH: usize = packed_length::<D>() + D - 1;

    /// That of a contact.
    pub fn new((body, partner, image): Identity<D>, force: SVector<f64, D>) -> TangentialForce<D> {
        TangentialForce { body, partner, image, force }
    }

    /// What tells its contact from all others.
    pub fn identity(&self) -> Identity<D> {
        (self.body, self.partner, self.image)
    }

    /// The bodies that it concerns.
    pub fn bodies(&self) -> impl Iterator<Item = usize> {
        bodies_of(self.identity())
    }

    /// It as numbers.
    pub fn pack(&self) -> Vec<f64> {
        let mut numbers = pack(self.identity(), self.force[0]);
        numbers.extend(self.force.iter().skip(1));
        numbers
    }

    /// What [`pack`](Self::pack) was given.
    pub fn unpack(numbers: &[f64]) -> TangentialForce<D> {
        let (identity, first) = unpack(&numbers[..packed_length::<D>()]);
        let rest = &numbers[packed_length::<D>()..];
        TangentialForce::new(identity, SVector::from_fn(|axis, _| if axis == 0 { first } else { rest[axis - 1] }))
    }
}
