//! A wall that a load presses on bodies: one more body of the problem of a step, with one degree of freedom, its place along its normal.
//!
//! Among the balls it is one of infinite radius, the last, whose centre is the foot of the perpendicular from the origin; it bounds the bodies from above.
//! Bodies may be fixed to it: a force on one of them moves the wall, and nothing else.

use nalgebra::SVector;

use super::{Contact, Identity, Partner};

/// The wall, and the bodies that are fixed to it; all of them have its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadedWall<'a> {
    /// The axis that it is normal to.
    pub axis: usize,
    /// Its place among the balls, the last.
    pub place: usize,
    /// Places of the bodies that are fixed to it, ascending.
    pub fixed: &'a [usize],
}

impl LoadedWall<'_> {
    /// Whether a body is the wall, or fixed to it.
    pub fn carries(&self, body: usize) -> bool {
        body == self.place || self.fixed.binary_search(&body).is_ok()
    }

    /// Whether one of the two of a contact is the wall or fixed to it.
    pub fn meets<const D: usize>(&self, contact: &Contact<D>) -> bool {
        self.carries(contact.body) || contact.other().is_some_and(|other| self.carries(other))
    }

    /// Whether two balls are no pair that can meet: both are fixed to the wall, or one is the wall, which is no ball.
    pub fn apart(&self, [one, other]: [usize; 2]) -> bool {
        one == self.place || other == self.place || self.carries(one) && self.carries(other)
    }

    /// A contact with the wall named as one of the box.
    pub fn of_box<const D: usize>(&self, contact: Contact<D>) -> Contact<D> {
        if contact.other() != Some(self.place) {
            return contact;
        }
        Contact { partner: Partner::Wall { axis: self.axis, upper: true }, sliding: SVector::zeros(), ..contact }
    }

    /// What tells a contact from all others, with the wall, named as one of the box, named as a body.
    pub fn of_body<const D: usize>(&self, (body, partner, image): Identity<D>) -> Identity<D> {
        let is_wall = partner == Partner::Wall { axis: self.axis, upper: true };
        (body, if is_wall { Partner::Body(self.place) } else { partner }, image)
    }

    /// The part of a unit force along a direction that moves what a body belongs to, squared.
    pub fn share<const D: usize>(&self, body: usize, direction: &SVector<f64, D>) -> f64 {
        if self.carries(body) { direction[self.axis].powi(2) } else { 1.0 }
    }

    /// The part of a direction in which what a body belongs to can move.
    pub fn along<const D: usize>(&self, body: usize, direction: SVector<f64, D>) -> SVector<f64, D> {
        if !self.carries(body) {
            return direction;
        }
        SVector::from_fn(|axis, _| if axis == self.axis { direction[axis] } else { 0.0 })
    }

    /// Gives the wall and all that is fixed to it the sum of what they have along its axis, of vectors that forces on bodies add up to.
    pub fn carry<T, const D: usize>(&self, of_bodies: &mut [T], vector: impl Fn(&mut T) -> &mut SVector<f64, D>) {
        let carried = || self.fixed.iter().copied().chain([self.place]);
        let sum: f64 = carried().map(|body| vector(&mut of_bodies[body])[self.axis]).sum();
        for body in carried() {
            *vector(&mut of_bodies[body]) = SVector::from_fn(|axis, _| if axis == self.axis { sum } else { 0.0 });
        }
    }
}

/// The place of what moves where a body is pushed: the body, or the wall that it is fixed to.
pub fn carrier(wall: Option<LoadedWall>, body: usize) -> usize {
    wall.filter(|wall| wall.carries(body)).map_or(body, |wall| wall.place)
}
