//! Granular bodies and the ranks that own them: each goes to the rank in whose part of the box its centre lies, with all that is known of it.

use nalgebra::{SMatrix, SVector};

use super::setup::{GranularBody, GranularSetup};
use crate::{
    body::{Regions, components, skew},
    contact::{AdhesiveContact, ContactForce, Identity, ProjectionShare, bodies_of, pack, packed_length, renamed, unpack},
    geometry::Domain,
    parallel::Peers,
    setup::{ContactHistory, Moving, Share, State},
};

/// What stays the same of a granular body on its way.
#[derive(Debug, Clone, Copy)]
pub struct Constants<const D: usize> {
    pub radius: f64,
    /// Mass, infinite if its motion is given.
    pub mass: f64,
    pub inertia: f64,
    /// Acceleration by the forces on it besides contacts, and the same of its spin.
    pub acceleration: SVector<f64, D>,
    pub spin_up: SMatrix<f64, D, D>,
}

impl<const D: usize> Constants<D> {
    const LENGTH: usize = 3 + D + D * (D - 1) / 2;

    fn of(body: &GranularBody<D>) -> Constants<D> {
        let GranularBody { radius, mass, inertia, acceleration, spin_up, .. } = *body;
        Constants { radius, mass, inertia, acceleration, spin_up }
    }

    fn pack(&self) -> Vec<f64> {
        let Constants { radius, mass, inertia, acceleration, spin_up } = self;
        [&[*radius, *mass, *inertia], acceleration.as_slice(), &components(spin_up)].concat()
    }

    fn unpack(numbers: &[f64]) -> Constants<D> {
        let (acceleration, spin_up) = numbers[3..].split_at(D);
        Constants {
            radius: numbers[0],
            mass: numbers[1],
            inertia: numbers[2],
            acceleration: SVector::from_column_slice(acceleration),
            spin_up: skew(spin_up),
        }
    }
}

/// The bodies that this rank owns at the start, and their state.
pub fn own_share<const D: usize>(peers: Peers, setup: &GranularSetup<D>, regions: &Regions<D>) -> (Vec<Constants<D>>, State<D>) {
    if peers.count() == 1 {
        return (setup.bodies.iter().map(Constants::of).collect(), setup.start());
    }
    let owned = |body: &GranularBody<D>| regions.owner(&setup.domain, &body.center) == peers.rank();
    let own: Vec<(usize, &GranularBody<D>)> = setup.bodies.iter().enumerate().filter(|(_, body)| owned(body)).collect();
    let share = Share::Own { numbers: own.iter().map(|(number, _)| *number).collect(), count: setup.bodies.len() };
    let state = State { share, wall: setup.wall(), ..State::start(own.iter().map(|(_, body)| (body.center, body.twist))) };
    (own.iter().map(|(_, body)| Constants::of(body)).collect(), state)
}

/// The part of a state of all bodies that is about those of a share, and their contacts.
///
/// # Panics
/// If it is not of all bodies.
pub fn own_part<const D: usize>(share: &Share, whole: State<D>) -> State<D> {
    assert_eq!(whole.share, Share::Whole, "a state of all bodies is cut");
    let Share::Own { numbers, .. } = share else { return whole };
    let own = |identity: Identity<D>| bodies_of(identity).any(|body| numbers.binary_search(&body).is_ok());
    State {
        bodies: numbers.iter().map(|&number| whole.bodies[number]).collect(),
        contact_history: whole.contact_history.into_iter().filter(|contact| own(contact.identity())).collect(),
        adhesive_contacts: whole.adhesive_contacts.into_iter().filter(|contact| own(contact.identity())).collect(),
        share: share.clone(),
        ..whole
    }
}

/// Sends bodies to the ranks that own the places where they are. Collective.
pub fn migrate<const D: usize>(
    peers: Peers,
    domain: &Domain<D>,
    regions: &Regions<D>,
    state: &mut State<D>,
    constants: &mut Vec<Constants<D>>,
) {
    let Share::Own { numbers, count } = &state.share else { return };
    let owners: Vec<usize> = state.bodies.iter().map(|body| regions.owner(domain, &body.center)).collect();
    if !peers.any(owners.iter().any(|&owner| owner != peers.rank())) {
        return;
    }
    let bodies = exchanged(peers, numbers, &owners, &state.bodies, constants);

    let now: Vec<usize> = bodies.iter().map(|&(number, ..)| number).collect();
    let owner_of = |number: usize| numbers.binary_search(&number).ok().map(|place| owners[place]);
    let moved = Migrated { peers, now: &now, owner_of: &owner_of };
    let (contact_history, length) = (std::mem::take(&mut state.contact_history), ContactHistory::<D>::LENGTH);
    state.contact_history = moved.contacts(contact_history, length, ContactHistory::identity, ContactHistory::pack, ContactHistory::unpack);
    let adhesive_contacts = moved.numbers(state.adhesive_contacts.iter().map(|contact| (contact.identity(), contact.gamma)).collect());
    state.adhesive_contacts = adhesive_contacts.into_iter().map(AdhesiveContact::from).collect();
    state.share = Share::Own { numbers: now, count: *count };
    (state.bodies, *constants) = bodies.into_iter().map(|(_, body, constants)| (body, constants)).unzip();
}

/// The bodies that this rank has once each was sent to its owner, by their numbers. Collective.
fn exchanged<const D: usize>(
    peers: Peers,
    numbers: &[usize],
    owners: &[usize],
    moving: &[Moving<D>],
    constants: &[Constants<D>],
) -> Vec<(usize, Moving<D>, Constants<D>)> {
    let mut bodies = Vec::with_capacity(owners.len());
    let mut letters = vec![Vec::new(); peers.count()];
    for (place, &owner) in owners.iter().enumerate() {
        let (number, body, constants) = (numbers[place], moving[place], constants[place]);
        if owner == peers.rank() {
            bodies.push((number, body, constants));
        } else {
            letters[owner].push(number as f64);
            letters[owner].extend(body.pack());
            letters[owner].extend(constants.pack());
        }
    }
    for record in peers.deliver(&letters).chunks(1 + Moving::<D>::LENGTH + Constants::<D>::LENGTH) {
        let (body, constants) = record[1..].split_at(Moving::<D>::LENGTH);
        bodies.push((record[0] as usize, Moving::unpack(body), Constants::unpack(constants)));
    }
    bodies.sort_unstable_by_key(|&(number, ..)| number);
    bodies
}

/// Where bodies are after they went to the ranks that own their places.
struct Migrated<'a> {
    peers: Peers<'a>,
    /// Numbers of the bodies that this rank has now.
    now: &'a [usize],
    /// The rank that has a body of which this one knew the contacts.
    owner_of: &'a dyn Fn(usize) -> Option<usize>,
}

impl Migrated<'_> {
    /// Numbers of contacts of the bodies that a rank has now, as [`contacts`](Self::contacts).
    fn numbers<const D: usize>(&self, known: Vec<(Identity<D>, f64)>) -> Vec<(Identity<D>, f64)> {
        let pack = |&(identity, number): &(Identity<D>, f64)| pack(identity, number);
        self.contacts(known, packed_length::<D>(), |(identity, _)| *identity, pack, unpack)
    }

    /// What is known of the contacts of the bodies that a rank has now, of those that it and others knew, each once, packed in so many numbers. Collective.
    fn contacts<const D: usize, T>(
        &self,
        mut known: Vec<T>,
        length: usize,
        identity: impl Fn(&T) -> Identity<D>,
        pack: impl Fn(&T) -> Vec<f64>,
        unpack: impl Fn(&[f64]) -> T,
    ) -> Vec<T> {
        let mut letters = vec![Vec::new(); self.peers.count()];
        for contact in &known {
            for rank in bodies_of(identity(contact)).filter_map(self.owner_of).filter(|&rank| rank != self.peers.rank()) {
                letters[rank].extend(pack(contact));
            }
        }
        known.extend(self.peers.deliver(&letters).chunks(length).map(unpack));
        known.retain(|contact| bodies_of(identity(contact)).any(|body| self.now.binary_search(&body).is_ok()));
        known.sort_unstable_by_key(&identity);
        known.dedup_by_key(|contact| identity(contact));
        known
    }
}

/// What contacts remember after a step, of all contacts of own bodies, named by their numbers: as the rank says that answers for each. Collective.
pub fn remembered<const D: usize>(
    peers: Peers,
    found: &ProjectionShare<D>,
    adhesive_contacts: &[AdhesiveContact<D>],
    remember: impl Fn(&[AdhesiveContact<D>], &[ContactForce<D>]) -> Vec<AdhesiveContact<D>>,
) -> Vec<AdhesiveContact<D>> {
    let view = &found.view;
    let placed = |number: usize| view.halo.place(number).expect("bodies that stick are seen");
    let before: Vec<AdhesiveContact<D>> =
        adhesive_contacts.iter().map(|contact| (renamed(contact.identity(), placed), contact.gamma).into()).collect();
    let after = remember(&before, &found.projection.forces);
    if !peers.any(!after.is_empty()) {
        return Vec::new();
    }
    let mut letters = vec![Vec::new(); peers.count()];
    let mut own = Vec::new();
    for contact in after.iter().filter(|contact| view.answers(contact.identity())) {
        let identity = renamed(contact.identity(), |place| view.halo.numbers()[place]);
        own.push((identity, contact.gamma).into());
        if let Some(rank) = view.across(contact.identity()) {
            letters[rank].extend(pack(identity, contact.gamma));
        }
    }
    own.extend(peers.deliver(&letters).chunks(packed_length::<D>()).map(|numbers| AdhesiveContact::from(unpack(numbers))));
    own.sort_unstable_by_key(AdhesiveContact::identity);
    own
}
