//! Contacts with friction in a flow: which take part in a step, what they bore in the last one, and what bodies resist as a network.

use std::collections::{HashMap, HashSet};

use super::{
    implicit_springs::{kept_apart, pair},
    quasi_static::{KnownInstant, Placed, QuasiStatic, velocities},
    travel::strain_rate,
};
use crate::{
    body::{Row, Twist},
    contact::{Contact, Identity},
    error::{Error, Result},
    friction::{ContactWrench, FlowContacts, NetworkResistance},
    interaction::Friction,
    setup::ContactHistory,
};

/// Gaps up to which pairs take part: so many times what they may close by in a step, and no less than this many radii of the largest body.
const CLOSING: f64 = 2.0;
const NEAREST: f64 = 0.02;

/// What contacts do to their partners, forces as vectors in space.
pub(super) type Wrenches<const D: usize> = HashMap<Identity<D>, ContactWrench<D>>;

impl<const D: usize> QuasiStatic<D> {
    /// What bodies resist as a network, with what ties them over a step.
    pub(super) fn network(&self, instant: &KnownInstant<D>, step: f64) -> NetworkResistance<D> {
        let resistance = self.suspension.resistance();
        // the network answers to mean forces over a step, with inertia to a part of those in its equations
        let scaled = |bond: Row<D>| Row { compliance: bond.compliance * resistance.of_impulse, ..bond };
        NetworkResistance { bonds: self.bonds(instant, step).into_iter().map(scaled).collect(), ..resistance.of_network() }
    }

    /// Contacts that may close in a step, and those that bear forces, in order.
    pub(super) fn may_touch(&self, instant: &KnownInstant<D>, twists: &[Twist<D>], step: f64, known: &Wrenches<D>) -> Vec<Contact<D>> {
        let placed = &instant.placed;
        let largest = self.radii.iter().copied().fold(0.0, f64::max);
        let closing = CLOSING * step / self.time_of_travel(placed, twists);
        let mut contacts = self.arrangement_of(placed, &placed.touching).near(closing.max(NEAREST) * largest);
        contacts.retain(self.untied(instant, step));
        let found: HashSet<Identity<D>> = contacts.iter().map(Contact::identity).collect();
        let others = known.keys().filter(|identity| !found.contains(*identity));
        contacts.extend(others.map(|&identity| contact_again(placed, identity)));
        contacts.sort_by_key(Contact::identity);
        contacts
    }

    /// Contacts that would close in the step, on the whole way, and that the rounds do not know.
    pub(super) fn missing<const W: usize>(
        &self,
        instant: &KnownInstant<D>,
        twists: &[Twist<D>],
        step: f64,
        known: &FlowContacts<D, W>,
    ) -> Result<Vec<Contact<D>>> {
        let known: HashSet<Identity<D>> = known.contacts.iter().map(Contact::identity).collect();
        let projection = self.contact_step(&instant.placed, step).project(&velocities(twists), &[])?;
        let active_contacts = projection.forces.into_iter().filter(|active| active.force > 0.0).map(|active| active.contact);
        let untied = self.untied(instant, step);
        Ok(active_contacts.filter(|contact| !known.contains(&contact.identity()) && untied(contact)).collect())
    }

    /// Tells whether nothing else holds the bodies of a contact at their distance over a step: neither welds nor stiff springs.
    fn untied<'a>(&self, instant: &'a KnownInstant<D>, step: f64) -> impl Fn(&Contact<D>) -> bool + 'a {
        let (tied, cluster_of) = (kept_apart(&instant.springs, &self.weights, step), instant.interactions.cluster_of());
        move |contact| {
            let sprung = contact.other().is_some_and(|other| tied.contains(&pair(contact.body, other)));
            !sprung && !contact.within_cluster(cluster_of, |body| body)
        }
    }
}

/// What to say where no motion keeps contacts.
pub(super) fn jammed<const D: usize>(instant: &KnownInstant<D>, step: f64) -> Error {
    let Friction { coefficient, roughness, .. } = instant.interactions.friction().expect("what jams has friction");
    let time = instant.placed.state.time;
    let domain = &instant.placed.domain;
    let strain = domain.strain(strain_rate(domain), time);
    let text = format!(
        "at time {time}, strain {strain:.4}, bodies are jammed: no motion of theirs keeps contacts apart in a step of {step:.3e} (contact.friction = \
         {coefficient}, roughness {roughness}); go on from the last checkpoint with less friction or roughness, or choose a lower fraction"
    );
    Error::StepTooLong { text, step }
}

/// A contact where its bodies are now.
pub(super) fn contact_again<const D: usize>(placed: &Placed<D>, identity: Identity<D>) -> Contact<D> {
    Contact::again(&placed.domain, &placed.touching, identity)
}

/// What contacts did in the last step.
pub(super) fn wrenches_of<const D: usize>(placed: &Placed<D>) -> Wrenches<D> {
    let wrench = |contact: &ContactHistory<D>| {
        let normal = contact_again(placed, contact.identity()).normal;
        let force = normal * (contact.force - normal.dot(&contact.tangential)) + contact.tangential;
        ContactWrench { force, couple: contact.couple }
    };
    placed.state.contact_history.iter().map(|contact| (contact.identity(), wrench(contact))).collect()
}

/// What contacts do, nothing where none is known.
pub(super) fn wrenches_at<const D: usize, const W: usize>(contacts: &FlowContacts<D, W>, known: &Wrenches<D>) -> Vec<ContactWrench<D>> {
    contacts.contacts.iter().map(|contact| known.get(&contact.identity()).copied().unwrap_or_else(ContactWrench::zero)).collect()
}
