//! Velocities of granular bodies, which live in the middle of steps, at their ends.

use nalgebra::{SMatrix, SVector};

use super::migration::Constants;
use crate::{
    body::Twist,
    contact::{AdhesiveContact, bodies_of},
    interaction::Wrench,
    parallel::Peers,
    setup::{ContactHistory, Moving, State},
};

/// Rates at which a motion changes.
#[derive(Clone, Copy)]
pub struct Acceleration<const D: usize> {
    pub velocity: SVector<f64, D>,
    pub spin: SMatrix<f64, D, D>,
}

impl<const D: usize> Acceleration<D> {
    /// That of a body by the forces on it and this push.
    pub fn of(body: &Constants<D>, push: &Wrench<D>) -> Self {
        Acceleration { velocity: body.acceleration + push.force / body.mass, spin: body.spin_up + push.torque / body.inertia }
    }

    /// A motion after a time.
    pub fn after(&self, twist: &Twist<D>, time: f64) -> Twist<D> {
        Twist { velocity: twist.velocity + self.velocity * time, spin: twist.spin + self.spin * time }
    }
}

/// Own bodies whose motions are those of an earlier time than their places.
pub struct HalfStepBehind<'a, const D: usize> {
    state: &'a State<D>,
    accelerations: &'a [Acceleration<D>],
    groups: &'a [Option<usize>],
    lag: f64,
    /// Whether each touches another.
    touched: Vec<bool>,
    /// Mean accelerations of what is tied together; none where anything touches it.
    of_groups: Vec<Option<SVector<f64, D>>>,
}

impl<'a, const D: usize> HalfStepBehind<'a, D> {
    /// Bodies that are behind by a lag, with their accelerations by all forces but those that a projection finds, and of each that is tied, by its number, the
    /// number of what it belongs to. Collective.
    pub fn new(
        peers: Peers,
        state: &'a State<D>,
        bodies: &[Constants<D>],
        accelerations: &'a [Acceleration<D>],
        groups: &'a [Option<usize>],
        lag: f64,
    ) -> Self {
        let mut behind = HalfStepBehind { state, accelerations, groups, lag, touched: touched(state), of_groups: Vec::new() };
        behind.of_groups = behind.group_accelerations(peers, bodies);
        behind
    }

    /// Their motions at the time of their places. Forces carry on bodies that nothing touches; those in contact, and what is tied to them, keep the
    /// motions with which their contacts were left. What is tied is carried on as a whole; clusters do not turn on yet.
    pub fn carried_on(&self) -> Vec<Twist<D>> {
        let HalfStepBehind { state, touched, of_groups, .. } = self;
        let now = |(place, body): (usize, &Moving<D>)| match self.group(state.number(place)) {
            Some(group) => {
                Twist { velocity: body.twist.velocity + of_groups[group].unwrap_or_else(SVector::zeros) * self.lag, ..body.twist }
            }
            None if touched[place] => body.twist,
            None => self.accelerations[place].after(&body.twist, self.lag),
        };
        state.bodies.iter().enumerate().map(now).collect()
    }

    /// What forces make of the motions of tied bodies one by one; of those that nothing touches.
    pub fn pushed(&self) -> Vec<Twist<D>> {
        let pushed = |(place, body): (usize, &Moving<D>)| match self.group(self.state.number(place)) {
            Some(group) if self.of_groups[group].is_some() => self.accelerations[place].after(&body.twist, self.lag),
            _ => body.twist,
        };
        self.state.bodies.iter().enumerate().map(pushed).collect()
    }

    fn group(&self, number: usize) -> Option<usize> {
        self.groups.get(number).copied().flatten()
    }

    /// See [`of_groups`](Self::of_groups). Collective.
    fn group_accelerations(&self, peers: Peers, bodies: &[Constants<D>]) -> Vec<Option<SVector<f64, D>>> {
        let count = self.groups.iter().flatten().max().map_or(0, |last| last + 1);
        if count == 0 {
            return Vec::new();
        }
        // of each its mass, contacts, and momentum over time
        let mut sums = vec![0.0; (D + 2) * count];
        for (place, (own, acceleration)) in bodies.iter().zip(self.accelerations).enumerate() {
            let Some(group) = self.group(self.state.number(place)) else { continue };
            let sum = &mut sums[group * (D + 2)..][..D + 2];
            sum[0] += own.mass;
            sum[1] += f64::from(self.touched[place]);
            (0..D).for_each(|axis| sum[2 + axis] += own.mass * acceleration.velocity[axis]);
        }
        peers.sum(&mut sums);
        let mean = |sum: &[f64]| (sum[1] == 0.0).then(|| SVector::from_fn(|axis, _| sum[2 + axis] / sum[0]));
        sums.chunks(D + 2).map(mean).collect()
    }
}

/// Of each own body whether it touches another.
fn touched<const D: usize>(state: &State<D>) -> Vec<bool> {
    let touching =
        state.contact_history.iter().map(ContactHistory::identity).chain(state.adhesive_contacts.iter().map(AdhesiveContact::identity));
    let mut touched = vec![false; state.bodies.len()];
    touching.flat_map(bodies_of).filter_map(|body| state.place(body)).for_each(|place| touched[place] = true);
    touched
}
