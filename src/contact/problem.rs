//! The problem of a step: bodies, weights, the velocities wanted, and the step itself.

use nalgebra::SVector;

use super::{Contact, ContactForce, LoadedWall, force::pushes};
use crate::geometry::{Ball, Domain};

/// Bodies that want to move for one step.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// Numbers of the bodies among all of the run, ascending; without them their places.
    pub numbers: Option<&'a [usize]>,
    /// The bodies, where they are before the step.
    pub balls: &'a [Ball<D>],
    /// Force per unit of velocity that a body is turned aside by (mass over step in a dry run, a resistance in
    /// Stokes flow): positive, and infinite for a body whose velocity is given.
    pub weights: &'a [f64],
    /// Velocities wanted.
    pub velocities: &'a [SVector<f64, D>],
    /// Length of the step.
    pub step: f64,
    /// Contacts that may pull, each with the least force that it may bear, which is negative; all others only push.
    ///
    /// Sorted by [`Contact::identity`].
    pub lower_bounds: &'a [ContactForce<D>],
    /// For each body of the run the number of the rigid cluster that it is in, from 1 on, or 0; empty without clusters. Balls of a cluster have no contacts.
    pub cluster_of: &'a [usize],
    /// The wall that a load presses on the bodies, the last of them, if there is one; the problem is then that of all bodies, by their places.
    pub wall: Option<LoadedWall<'a>>,
}

impl<'a, const D: usize> Problem<'a, D> {
    /// All bodies, by their places, whose contacts only push, without clusters or a wall under a load.
    pub fn new(
        domain: &'a Domain<D>,
        balls: &'a [Ball<D>],
        weights: &'a [f64],
        velocities: &'a [SVector<f64, D>],
        step: f64,
    ) -> Problem<'a, D> {
        Problem { domain, numbers: None, balls, weights, velocities, step, lower_bounds: &[], cluster_of: &[], wall: None }
    }

    /// The number of the body at a place.
    pub(crate) fn number(&self, place: usize) -> usize {
        self.numbers.map_or(place, |numbers| numbers[place])
    }

    /// The numbers of all bodies.
    pub(crate) fn all_numbers(&self) -> Vec<usize> {
        self.numbers.map_or_else(|| (0..self.balls.len()).collect(), <[usize]>::to_vec)
    }

    /// Whether a contact is of two balls of one cluster.
    pub(crate) fn within_cluster(&self, contact: &Contact<D>) -> bool {
        contact.within_cluster(self.cluster_of, |place| self.number(place))
    }

    /// Whether a body can be turned aside.
    pub(crate) fn gives_way(&self, body: usize) -> bool {
        self.weights[body].is_finite()
    }

    /// Linearised gap after the step.
    pub(crate) fn gap_after(&self, contact: &Contact<D>, velocities: &[SVector<f64, D>]) -> f64 {
        contact.gap + self.step * contact.opening(velocities)
    }

    /// How easily a contact opens: the sum of the inverse weights of its bodies.
    pub(crate) fn mobility(&self, contact: &Contact<D>) -> f64 {
        let of_body = |body: usize| self.wall.map_or(1.0, |wall| wall.share(body, &contact.normal)) / self.weights[body];
        of_body(contact.body) + contact.other().map_or(0.0, of_body)
    }

    /// The least force that a contact may bear.
    pub(crate) fn lower_bound(&self, contact: &Contact<D>) -> f64 {
        let found = self.lower_bounds.binary_search_by_key(&contact.identity(), |floor| floor.contact.identity());
        found.map_or(0.0, |place| self.lower_bounds[place].force)
    }

    /// The wanted velocities, corrected by what contact forces do to them.
    pub(crate) fn corrected_velocities(&self, contacts: &[Contact<D>], forces: &[f64]) -> Vec<SVector<f64, D>> {
        let forces = contacts.iter().zip(forces).map(|(&contact, &force)| ContactForce::normal(contact, force));
        let mut pushes = pushes(self.balls.len(), forces);
        if let Some(wall) = self.wall {
            wall.carry(&mut pushes, |push| push);
        }
        (0..pushes.len()).map(|body| self.velocities[body] + pushes[body] / self.weights[body]).collect()
    }
}
