//! The bodies of a rank with those near them, as interactions see them.

use super::migration::Constants;
use crate::{
    body::{Halo, OwnBodies, Regions},
    contact::{AdhesiveContact, ContactForce, renamed},
    geometry::{Ball, Domain},
    interaction::Arrangement,
    parallel::Peers,
    setup::State,
};

/// The own bodies of a rank and all others within reach, by their places in a halo.
pub struct Neighbours<const D: usize> {
    /// Whose they are.
    pub halo: Halo,
    /// The contacts that stick.
    pub adhesive_contacts: Vec<AdhesiveContact<D>>,
    balls: Vec<Ball<D>>,
    masses: Vec<f64>,
}

impl<const D: usize> Neighbours<D> {
    /// Those with a gap up to `reach` to an own body, and those that stick to one of the own bodies; `bodies` are these. Collective.
    pub fn new(
        peers: Peers,
        domain: &Domain<D>,
        regions: &Regions<D>,
        state: &State<D>,
        bodies: &[Constants<D>],
        adhesive_contacts: &[AdhesiveContact<D>],
        reach: f64,
    ) -> Neighbours<D> {
        let (radii, masses): (Vec<f64>, Vec<f64>) = bodies.iter().map(|body| (body.radius, body.mass)).unzip();
        let balls = state.balls(&radii);
        let around: Vec<Ball<D>> = balls.iter().map(|ball| Ball { radius: ball.radius + 0.5 * reach, ..*ball }).collect();
        let numbers = state.numbers();
        let required = adhesive_contacts.iter().flat_map(|contact| contact.bodies());
        let halo = Halo::new(peers, &OwnBodies { domain, regions, numbers: &numbers, around: &around }, required);
        let place = |number: usize| halo.place(number).expect("bodies that stick are seen");
        let adhesive_contacts =
            adhesive_contacts.iter().map(|contact| (renamed(contact.identity(), place), contact.gamma).into()).collect();
        Neighbours { balls: halo.spread_balls(peers, &balls), masses: halo.spread(peers, &masses), adhesive_contacts, halo }
    }

    /// They as interactions see them at a time.
    pub fn arrangement<'a>(&'a self, domain: &'a Domain<D>, reach: f64, time: f64) -> Arrangement<'a, D> {
        let numbers = Some(self.halo.numbers());
        Arrangement { domain, numbers, balls: &self.balls, weights: &self.masses, viscosity: None, reach, time }
    }

    /// Those of the contacts that concern an own body; bodies are named by their numbers.
    pub fn own_contacts(&self, contacts: Vec<ContactForce<D>>) -> Vec<ContactForce<D>> {
        let own = |force: &ContactForce<D>| {
            self.halo.owns(force.contact.body) || force.contact.other().is_some_and(|other| self.halo.owns(other))
        };
        let numbered =
            |force: ContactForce<D>| ContactForce { contact: force.contact.renamed(|place| self.halo.numbers()[place]), ..force };
        contacts.into_iter().filter(own).map(numbered).collect()
    }
}
