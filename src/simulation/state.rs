//! What a restart needs: where bodies are and how they move. A value; machinery is rebuilt.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::Twist,
    contact::{AdhesiveContact, ContactForce, Identity, Memory, Partner},
    geometry::Ball,
};

/// A body on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moving<const D: usize> {
    /// Its centre, not moved back into the box: what it has travelled can be read off.
    pub center: SVector<f64, D>,
    /// How it has turned since the start, an orthogonal matrix.
    pub rotation: SMatrix<f64, D, D>,
    /// Its motion over the last step: in a dry run its velocity, in Stokes flow the one that the flow gave it.
    pub twist: Twist<D>,
}

/// A contact force of the last step: a place to start from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactHistory<const D: usize> {
    /// The body.
    pub body: usize,
    /// What it touched.
    pub partner: Partner,
    /// Which image of the partner.
    pub image: [i32; D],
    /// The force between them.
    pub force: f64,
}

/// The bodies at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct State<const D: usize> {
    /// The time.
    pub time: f64,
    /// Steps made so far.
    pub steps: usize,
    /// Length of the last step, 0 before the first.
    pub last_step: f64,
    /// The bodies.
    pub bodies: Vec<Moving<D>>,
    /// Contacts that bore a force.
    pub held: Vec<ContactHistory<D>>,
    /// Contacts that stick; none unless contacts are gluey.
    pub stuck: Vec<AdhesiveContact<D>>,
}

impl<const D: usize> ContactHistory<D> {
    /// The memory of a contact force.
    pub fn of(contact: &ContactForce<D>) -> ContactHistory<D> {
        let ContactForce { contact, force } = *contact;
        ContactHistory { body: contact.body, partner: contact.partner, image: contact.image, force }
    }

    /// What tells its contact from all others.
    pub fn identity(&self) -> Identity<D> {
        (self.body, self.partner, self.image)
    }
}

impl<const D: usize> State<D> {
    /// Bodies at the start.
    pub fn start(bodies: impl Iterator<Item = (SVector<f64, D>, Twist<D>)>) -> State<D> {
        let moving = |(center, twist)| Moving { center, rotation: SMatrix::identity(), twist };
        State { time: 0.0, steps: 0, last_step: 0.0, bodies: bodies.map(moving).collect(), held: Vec::new(), stuck: Vec::new() }
    }

    /// Their centres, not moved back into the box.
    pub fn centers(&self) -> Vec<SVector<f64, D>> {
        self.bodies.iter().map(|body| body.center).collect()
    }

    /// The bodies as balls with these radii.
    pub fn balls(&self, radii: &[f64]) -> Vec<Ball<D>> {
        self.bodies.iter().zip(radii).map(|(body, &radius)| Ball { center: body.center, radius }).collect()
    }

    /// The contact forces of the last step.
    pub fn memory(&self) -> Memory<D> {
        self.held.iter().map(|held| ((held.body, held.partner, held.image), held.force)).collect()
    }

    /// Moves every body for a step.
    pub fn advance(&mut self, moves: &[Twist<D>], step: f64) {
        for (body, twist) in self.bodies.iter_mut().zip(moves) {
            body.center += twist.velocity * step;
            body.rotation = turn(&twist.spin, step) * body.rotation;
        }
        self.time += step;
        self.steps += 1;
        self.last_step = step;
    }
}

/// The rotation by a spin over a step (Cayley's formula: orthogonal whatever the step, second order in it).
fn turn<const D: usize>(spin: &SMatrix<f64, D, D>, step: f64) -> SMatrix<f64, D, D> {
    let half = nalgebra::DMatrix::from_fn(D, D, |row, column| spin[(row, column)] * 0.5 * step);
    let one = nalgebra::DMatrix::identity(D, D);
    let turned = (&one - &half).lu().solve(&(&one + &half)).expect("one minus a skew matrix is regular");
    SMatrix::from_fn(|row, column| turned[(row, column)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::skew;

    #[test]
    fn many_small_turns_make_the_right_angle_and_stay_orthogonal() {
        let at_rest = Twist { velocity: SVector::zeros(), spin: skew::<3>(&[0.0, 0.0, 1.0]) };
        let mut state = State::<3>::start(std::iter::once((SVector::zeros(), at_rest)));
        let steps = 1000;
        (0..steps).for_each(|_| state.advance(&[at_rest], 0.5 * std::f64::consts::PI / f64::from(steps)));
        let rotation = state.bodies[0].rotation;
        assert!((rotation.transpose() * rotation - SMatrix::identity()).norm() < 1e-12);
        assert!((rotation * SVector::from([1.0, 0.0, 0.0]) - SVector::from([0.0, 1.0, 0.0])).norm() < 1e-6);
        assert!((state.time - 0.5 * std::f64::consts::PI).abs() < 1e-12);
    }
}
