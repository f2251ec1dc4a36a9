//! Friction of dry bodies that are tied: chains, cells and rigid clusters.
//!
//! Ties answer to what contacts change motions by, linearly but for small rotations in a step; the exact law is solved for that answer, and both in turn until
//! nothing changes. Every rank knows all bodies, and finds the same.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::SVector;

use super::{
    Granular,
    all_bodies::{AllBodies, all_normal_forces, all_twists},
    chains::GranularStep,
    ties::Ties,
    together::{gathered_rigid_twists, gathered_ties},
};
use crate::{
    body::{Row, Twist},
    contact::{Contact, ContactForce, FrictionReport, Identity, Problem},
    friction::{ContactWrench, FrictionIsland, FrictionLaw, RigidTwists, TiedFriction, contacts_on_the_way},
    setup::State,
};

/// Rounds that ties and friction are given, and the change of places in a step, in radii of the smallest body, that is none.
const ROUNDS: usize = 12;
const AGREEMENT: f64 = 1e-10;

/// Gap, in radii, below which pairs have friction before they press.
const NEAR: f64 = 0.02;

/// What friction does in a step to bodies that are tied.
pub(super) struct Rubbing<const D: usize> {
    /// What contacts change the motions of own bodies by.
    pub changes: Vec<Twist<D>>,
    /// The same of all bodies.
    all: Vec<Twist<D>>,
    step: GranularStep,
    bodies: AllBodies<D>,
    rigid: Vec<RigidTwists<D>>,
    rows: Vec<Row<D>>,
    contacts: Vec<Contact<D>>,
    laws: Vec<FrictionLaw>,
    wrenches: Vec<ContactWrench<D>>,
    cost: [usize; 2],
}

impl<const D: usize> Granular<D> {
    /// What friction changes motions by that bodies want. Collective.
    pub(super) fn rub(&self, state: &State<D>, moves: &[Twist<D>], step: GranularStep) -> Rubbing<D> {
        let (peers, surfaces) = (self.peers(), self.interactions.surfaces());
        let wanted: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
        let mut known: BTreeMap<Identity<D>, ContactWrench<D>> = BTreeMap::new();
        let last = state.whole_contact_history(self.session.world());
        let mut rubbing = Rubbing::none(moves.len(), step);
        for round in 0..ROUNDS {
            let turned: Vec<Twist<D>> = moves.iter().zip(&rubbing.changes).map(|(twist, change)| spun(twist, change)).collect();
            let ties = Ties::new(peers, &self.interactions, state, &self.bodies, &turned, step);
            let mut ties = ties.expect("bodies are tied");
            let changes: Vec<SVector<f64, D>> = rubbing.changes.iter().map(|change| change.velocity).collect();
            let held = ties.hold(peers, &wanted, &changes);
            let (linear, rigid) = ties.linear_twists(peers, moves, &rubbing.changes, &held, &self.masses());
            rubbing.rigid = gathered_rigid_twists(peers, &rigid);
            rubbing.bodies = self.all_bodies(state, &linear, &held);
            if round == 0 {
                known = rubbing.bodies.last_wrenches(&self.domain, &last);
            }
            rubbing.rows = gathered_ties(peers, &ties.rows(&(0..state.count()).collect()));
            let is_new = rubbing.meet(self, &mut known);
            if rubbing.contacts.is_empty() {
                break;
            }
            rubbing.laws = rubbing.contacts.iter().map(|contact| surfaces.of(contact.identity())).collect();
            let guess: Vec<ContactWrench<D>> = rubbing.contacts.iter().map(|contact| known[&contact.identity()]).collect();
            let found = rubbing.problem(self).solve(&guess);
            rubbing.cost = [rubbing.cost[0].max(found.sweeps), rubbing.cost[1].max(found.iterations)];
            known.extend(rubbing.contacts.iter().map(Contact::identity).zip(found.wrenches.iter().copied()));
            rubbing.wrenches = found.wrenches;
            if rubbing.take(state) <= AGREEMENT && !is_new {
                break;
            }
        }
        rubbing
    }

    /// How well friction was kept by motions over the step, of own bodies. Collective.
    pub(super) fn friction_report(
        &self,
        state: &State<D>,
        rubbing: &Rubbing<D>,
        moves: &[Twist<D>],
        normal: &[ContactForce<D>],
    ) -> FrictionReport {
        let twists = all_twists(self.peers(), state, moves);
        let normal_forces = all_normal_forces(self.peers(), normal);
        let whole = |(contact, wrench): (&Contact<D>, &ContactWrench<D>)| {
            let force = normal_forces.get(&contact.identity()).copied().unwrap_or(0.0);
            ContactWrench { force: wrench.force + contact.normal * force, ..*wrench }
        };
        let wrenches: Vec<ContactWrench<D>> = rubbing.contacts.iter().zip(&rubbing.wrenches).map(whole).collect();
        let starts = all_twists(self.peers(), state, &state.twists());
        let report = rubbing.problem(self).report(&wrenches, &starts, &twists);
        FrictionReport { sweeps: rubbing.cost[0], iterations: rubbing.cost[1], ..report }
    }
}

impl<const D: usize> Rubbing<D> {
    fn none(own: usize, step: GranularStep) -> Rubbing<D> {
        let (bodies, changes) = (AllBodies::default(), vec![Twist::zero(); own]);
        Rubbing {
            changes,
            all: Vec::new(),
            step,
            bodies,
            rigid: Vec::new(),
            rows: Vec::new(),
            contacts: Vec::new(),
            laws: Vec::new(),
            wrenches: Vec::new(),
            cost: [0; 2],
        }
    }

    /// Takes the contacts that are known and those that come near; whether there are new ones. Bodies of a bond do not rub on each other.
    fn meet(&mut self, granular: &Granular<D>, known: &mut BTreeMap<Identity<D>, ContactWrench<D>>) -> bool {
        let bodies = &self.bodies;
        let weights: Vec<f64> = bodies.masses.iter().map(|[mass, _]| mass / self.step.push).collect();
        let problem = Problem {
            cluster_of: granular.interactions.cluster_of(),
            ..Problem::new(&granular.domain, &bodies.balls, &weights, &bodies.held, self.step.length)
        };
        let bonded: BTreeSet<[usize; 2]> = self.rows.iter().filter_map(joined).collect();
        let rubs = |contact: &Contact<D>| {
            contact.other().is_none_or(|other| !bonded.contains(&[contact.body.min(other), contact.body.max(other)]))
        };
        let before = known.len();
        for contact in contacts_on_the_way(&problem, NEAR).iter().filter(|contact| rubs(contact)) {
            known.entry(contact.identity()).or_insert_with(ContactWrench::zero);
        }
        let again = |&identity: &Identity<D>| Contact::again(&granular.domain, &bodies.balls, identity);
        let all: Vec<Contact<D>> = known.keys().map(again).filter(rubs).collect();
        self.contacts = all;
        known.len() > before
    }

    fn problem<'a>(&'a self, granular: &'a Granular<D>) -> TiedFriction<'a, D> {
        let (AllBodies { balls, masses, twists, .. }, GranularStep { length: step, push: duration }) = (&self.bodies, self.step);
        let (domain, tolerance) = (&granular.domain, granular.friction_tolerance());
        let island =
            FrictionIsland { domain, balls, masses, twists, step, contacts: &self.contacts, laws: &self.laws, duration, wall: None };
        TiedFriction { island, rigid: &self.rigid, ties: &self.rows, tolerance }
    }

    /// Changes the motions of own bodies by the wrenches; the largest change of a place since the last time, in radii of the smallest body.
    fn take(&mut self, state: &State<D>) -> f64 {
        let mut all = vec![Twist::zero(); self.bodies.balls.len()];
        for (contact, wrench) in self.contacts.iter().zip(&self.wrenches) {
            for (body, push) in wrench.on_bodies(contact, &self.bodies.balls) {
                let [mass, inertia] = self.bodies.masses[body];
                all[body].velocity += push.velocity * (self.step.push / mass);
                all[body].spin += push.spin * (self.step.push / inertia);
            }
        }
        let radii = self.bodies.balls.iter().map(|ball| ball.radius);
        let unit = radii.fold(f64::INFINITY, f64::min);
        let moved = |(one, other): (&Twist<D>, &Twist<D>)| {
            ((one.velocity - other.velocity).norm() / unit + (one.spin - other.spin).norm()) * self.step.length
        };
        self.all.resize(all.len(), Twist::zero());
        // of all bodies: every rank goes on as long as the others
        let most = all.iter().zip(&self.all).map(moved).fold(0.0, f64::max);
        self.changes = (0..self.changes.len()).map(|place| all[state.number(place)]).collect();
        self.all = all;
        most
    }

    /// The forces of contacts of own bodies, of bodies by number, with those normal ones that were found besides.
    pub(super) fn forces(&self, state: &State<D>, normal: Vec<ContactForce<D>>) -> Vec<ContactForce<D>> {
        let mut forces: BTreeMap<Identity<D>, ContactForce<D>> =
            normal.into_iter().map(|force| (force.contact.identity(), force)).collect();
        let own =
            |contact: &Contact<D>| [Some(contact.body), contact.other()].into_iter().flatten().any(|body| state.place(body).is_some());
        for (contact, wrench) in self.contacts.iter().zip(&self.wrenches).filter(|(contact, _)| own(contact)) {
            let along = wrench.force.dot(&contact.normal);
            let whole = forces.entry(contact.identity()).or_insert_with(|| ContactForce::normal(*contact, 0.0));
            whole.force += along;
            whole.tangential += wrench.force - contact.normal * along;
        }
        forces.into_values().filter(|force| force.force > 0.0).collect()
    }
}

/// The two bodies of a bond.
fn joined<const D: usize>(row: &Row<D>) -> Option<[usize; 2]> {
    match row.ends[..] {
        [(one, _), (other, _)] => Some([one.min(other), one.max(other)]),
        _ => None,
    }
}

/// A motion whose spin a change changes.
fn spun<const D: usize>(twist: &Twist<D>, change: &Twist<D>) -> Twist<D> {
    Twist { spin: twist.spin + change.spin, ..*twist }
}
