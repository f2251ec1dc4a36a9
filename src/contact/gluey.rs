//! Gluey contacts: what is left of a film of fluid between surfaces when its viscosity vanishes.
//!
//! A film between surfaces at a gap `q` resists with `-e q'/q`, so that `q' + e ln q` changes by the other forces only. As `e`
//! goes to zero, `e ln q` becomes a memory `gamma` (Maury, ESAIM Proc. 18 (2007) 133; Lefebvre, M2AN 43 (2009) 53):
//!
//! ```text
//! q' + gamma = q'(0) + (impulse of all forces besides the contact's)      q >= 0   gamma <= 0   q gamma = 0
//! ```
//!
//! A contact that was pressed together holds on until it was pulled apart as much. A step conserves the sum exactly: its contact
//! forces are those of a projection in which a contact may pull, but no more than takes its memory back to zero. A rough
//! surface ends the film at some gap: `gamma` then falls no lower than a given least value.

use std::collections::HashMap;

use super::{Contact, ContactForce, Identity, Partner};
use crate::geometry::{Ball, Domain};

/// Changes of memory below this part of the largest are rounding.
const ROUNDING: f64 = 1e-12;

/// A contact that sticks, and its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stuck<const D: usize> {
    /// The body.
    pub body: usize,
    /// What it sticks to.
    pub partner: Partner,
    /// Which image of the partner.
    pub image: [i32; D],
    /// Impulse with which it was pressed, as a negative number, over a unit: see [`floors`].
    pub gamma: f64,
}

impl<const D: usize> Stuck<D> {
    /// What tells its contact from all others.
    pub fn identity(&self) -> Identity<D> {
        (self.body, self.partner, self.image)
    }
}

/// The contacts that stick, each with the least force that it may bear for a step; `unit` is the impulse of a `gamma` of one.
pub fn floors<const D: usize>(
    (domain, balls): (&Domain<D>, &[Ball<D>]),
    stuck: &[Stuck<D>],
    step: f64,
    unit: impl Fn(&Contact<D>) -> f64,
) -> Vec<ContactForce<D>> {
    let floor = |stuck: &Stuck<D>| {
        let contact = Contact::again(domain, balls, stuck.identity());
        ContactForce { contact, force: stuck.gamma * unit(&contact) / step }
    };
    let mut floors: Vec<_> = stuck.iter().map(floor).collect();
    floors.sort_unstable_by_key(|floor| floor.contact.identity());
    floors
}

/// The contacts that stick after a step with these forces, with a memory not below `least`.
pub fn remembered<const D: usize>(
    forces: &[ContactForce<D>],
    stuck: &[Stuck<D>],
    (step, least): (f64, f64),
    unit: impl Fn(&Contact<D>) -> f64,
) -> Vec<Stuck<D>> {
    let before: HashMap<_, _> = stuck.iter().map(|stuck| (stuck.identity(), stuck.gamma)).collect();
    let change = |force: &ContactForce<D>| -step * force.force / unit(&force.contact);
    let all = forces.iter().map(change).chain(before.values().copied());
    let rounding = ROUNDING * all.fold(0.0, |largest: f64, part| largest.max(part.abs()));
    let after = |force: &ContactForce<D>| {
        let (body, partner, image) = force.contact.identity();
        let gamma = before.get(&(body, partner, image)).copied().unwrap_or(0.0) + change(force);
        (gamma < -rounding).then_some(Stuck { body, partner, image, gamma: gamma.max(least) })
    };
    forces.iter().filter_map(after).collect()
}
