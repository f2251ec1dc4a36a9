//! What every rank knows of all bodies where these are tied and rub.

use std::collections::BTreeMap;

use nalgebra::SVector;

use super::Granular;
use crate::{
    body::{Twist, components, skew},
    contact::{Contact, ContactForce, Identity, pack, packed_length, unpack},
    friction::ContactWrench,
    geometry::{Ball, Domain},
    parallel::Peers,
    setup::{ContactHistory, State},
};

/// All bodies, by number.
#[derive(Default)]
pub struct AllBodies<const D: usize> {
    pub balls: Vec<Ball<D>>,
    pub masses: Vec<[f64; 2]>,
    /// Motions without what contacts change.
    pub twists: Vec<Twist<D>>,
    /// Velocities over the step.
    pub held: Vec<SVector<f64, D>>,
}

impl<const D: usize> Granular<D> {
    /// All bodies, on every rank. Collective.
    pub(super) fn all_bodies(&self, state: &State<D>, linear: &[Twist<D>], held: &[SVector<f64, D>]) -> AllBodies<D> {
        let mut letters = Vec::new();
        for (place, own) in self.bodies.iter().enumerate() {
            letters.extend([state.number(place) as f64, own.radius, own.mass, own.inertia]);
            letters.extend(state.bodies[place].center.iter().chain(linear[place].velocity.iter()).chain(held[place].iter()));
            letters.extend(components(&linear[place].spin));
        }
        let letters = self.peers().gather(&letters);
        let mut bodies: Vec<&[f64]> = letters.chunks(4 + 3 * D + D * (D - 1) / 2).collect();
        bodies.sort_by_key(|body| body[0] as usize);
        let vector = |body: &[f64], number: usize| SVector::from_column_slice(&body[4 + number * D..4 + (number + 1) * D]);
        AllBodies {
            balls: bodies.iter().map(|body| Ball { center: vector(body, 0), radius: body[1] }).collect(),
            masses: bodies.iter().map(|body| [body[2], body[3]]).collect(),
            twists: bodies.iter().map(|body| Twist { velocity: vector(body, 1), spin: skew(&body[4 + 3 * D..]) }).collect(),
            held: bodies.iter().map(|body| vector(body, 2)).collect(),
        }
    }
}

impl<const D: usize> AllBodies<D> {
    /// The forces of the last step where bodies are now.
    pub fn last_wrenches(&self, domain: &Domain<D>, last: &[ContactHistory<D>]) -> BTreeMap<Identity<D>, ContactWrench<D>> {
        let again = |history: &ContactHistory<D>| {
            let contact = Contact::again(domain, &self.balls, history.identity());
            (history.identity(), ContactWrench::of_force(contact.normal * history.force + history.tangential))
        };
        last.iter().map(again).collect()
    }
}

/// Motions of all bodies, by number. Collective.
pub fn all_twists<const D: usize>(peers: Peers, state: &State<D>, own: &[Twist<D>]) -> Vec<Twist<D>> {
    let mut letters = Vec::new();
    for (place, twist) in own.iter().enumerate() {
        letters.push(state.number(place) as f64);
        letters.extend(twist.velocity.iter().copied().chain(components(&twist.spin)));
    }
    let letters = peers.gather(&letters);
    let mut bodies: Vec<&[f64]> = letters.chunks(1 + D + D * (D - 1) / 2).collect();
    bodies.sort_by_key(|body| body[0] as usize);
    bodies.iter().map(|body| Twist { velocity: SVector::from_column_slice(&body[1..=D]), spin: skew(&body[1 + D..]) }).collect()
}

/// Normal forces by contact, of all ranks. Collective.
pub fn all_normal_forces<const D: usize>(peers: Peers, own: &[ContactForce<D>]) -> BTreeMap<Identity<D>, f64> {
    let letters: Vec<f64> = own.iter().flat_map(|force| pack(force.contact.identity(), force.force)).collect();
    peers.gather(&letters).chunks(packed_length::<D>()).map(unpack).collect()
}
