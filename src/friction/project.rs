//! Velocities and spins that keep contacts with friction: friction is solved for the contacts that pressed in the last step; then the least change of these
//! velocities lets nothing overlap, without more friction. Contacts that press in it and are new join, and both are solved again until none is. So nothing overlaps,
//! however well friction was solved, and what was found of it stays: forces of the change are small, and only push, so that none leaves its cone.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{SMatrix, SVector};

use super::{
    ContactWrench, FrictionProjection, FrictionShare,
    certificate::{Certified, certify},
    frame::Frame,
    islands::{Cost, Shared, Wrenches},
};
use crate::{
    body::{Halo, Twist},
    contact::{
        Contact, ContactForce, FrictionReport, Identity, KktReport, Memory, Problem, ProblemShare, ProjectionShare, View, bodies_of,
        kkt_report,
        paths::{Motions, common_motion, paths},
        project_share, renamed,
    },
    error::Result,
    linalg::CANCELLATION,
    parallel::Peers,
};

/// Times that contacts are added before the forces are taken as they are.
const ROUNDS: usize = 20;

/// Gap, in radii, below which pairs have friction before they press.
const NEAR: f64 = 0.02;

/// Where the rounds stand on a rank.
struct ProjectionRounds<'a, const D: usize> {
    peers: Peers<'a>,
    share: &'a ProblemShare<'a, D>,
    friction: &'a FrictionShare<'a, D>,
    /// All contacts of own bodies that friction knows, of bodies by number.
    contacts: BTreeMap<Identity<D>, Contact<D>>,
    /// Wrenches at them, found or to start from.
    wrenches: Wrenches<D>,
    /// Those that joined after friction was solved last.
    fresh: BTreeSet<Identity<D>>,
    /// What friction changes the motions of own bodies by.
    changes: Vec<Twist<D>>,
    cost: Cost,
}

/// Bodies that this rank knows.
struct LocalView<const D: usize> {
    view: View<D>,
    masses: Vec<[f64; 2]>,
    twists: Vec<Twist<D>>,
    contacts: Vec<Contact<D>>,
}

/// A rank's part of velocities and spins that let nothing overlap and obey the law of friction, found sooner if forces are like those of an earlier step.
/// Collective: each rank gives its own bodies.
///
/// # Errors
/// As [`project_share`].
pub fn project_with_friction<const D: usize>(
    peers: Peers,
    share: &ProblemShare<D>,
    friction: &FrictionShare<D>,
    memory: &Memory<D>,
) -> Result<FrictionProjection<D>> {
    let mut rounds = ProjectionRounds::new(peers, share, friction);
    rounds.begin(memory);
    rounds.solve();
    let none = Memory::default();
    let mut found = rounds.separate(if peers.any(!rounds.contacts.is_empty()) { &none } else { memory })?;
    for _ in 0..ROUNDS {
        if !rounds.meet(&found) {
            break;
        }
        rounds.solve();
        found = rounds.separate(&Memory::default())?;
    }
    Ok(rounds.finish(found))
}

impl<'a, const D: usize> ProjectionRounds<'a, D> {
    fn new(peers: Peers<'a>, share: &'a ProblemShare<'a, D>, friction: &'a FrictionShare<'a, D>) -> Self {
        let (changes, cost) = (vec![Twist::zero(); friction.spins.len()], Cost::default());
        let (contacts, wrenches, fresh) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
        ProjectionRounds { peers, share, friction, contacts, wrenches, fresh, changes, cost }
    }

    /// Takes the contacts that pressed in the last step, with their forces, and those that come near; none if none pressed.
    fn begin(&mut self, memory: &Memory<D>) {
        let last = self.last_contacts();
        if !self.peers.any(!last.is_empty()) {
            return;
        }
        for (tangential, contact) in self.friction.last.values().zip(last) {
            self.join(contact, contact.normal * memory.force(&contact.identity()) + tangential);
        }
        let motions = self.motions(self.share.problem.velocities);
        let view = View::new(self.peers, self.share, &motions, NEAR, &[]);
        let problem = view.problem(&self.share.problem);
        let seen = Motions { velocities: &view.velocities, ..motions };
        let paths = paths(&problem, &seen, NEAR, |body| view.halo.owns(body)).into_iter();
        for path in paths.filter(|path| path.smallest_gap < NEAR * path.contact.smaller_radius(problem.balls)) {
            self.join(view.numbered(&path.contact), SVector::zeros());
        }
    }

    /// Takes a contact of bodies by number, if it is new.
    fn join(&mut self, contact: Contact<D>, force: SVector<f64, D>) {
        let identity = contact.identity();
        if self.contacts.insert(identity, contact).is_none() {
            self.wrenches.insert(identity, ContactWrench::of_force(force));
            self.fresh.insert(identity);
        }
    }

    /// The contacts that pressed in the last step, where bodies are now. Collective.
    fn last_contacts(&self) -> Vec<Contact<D>> {
        let (peers, problem, last) = (self.peers, &self.share.problem, self.friction.last);
        let halo = Halo::of_numbers(peers, &problem.all_numbers(), last.keys().flat_map(|&identity| bodies_of(identity)));
        let balls = halo.spread_balls(peers, problem.balls);
        let place = |number: usize| halo.place(number).expect("bodies of contacts are seen");
        let again = |identity| Contact::again(problem.domain, &balls, renamed(identity, place)).renamed(|place| halo.numbers()[place]);
        last.keys().map(|&identity| again(identity)).collect()
    }

    /// The velocities without overlap next to those that friction makes of the wanted ones.
    fn separate(&self, memory: &Memory<D>) -> Result<ProjectionShare<D>> {
        let wanted = self.share.problem.velocities.iter().zip(&self.changes);
        let velocities: Vec<SVector<f64, D>> = wanted.map(|(wanted, change)| wanted + change.velocity).collect();
        let problem = Problem { velocities: &velocities, ..self.share.problem };
        project_share(self.peers, &ProblemShare { problem, ..*self.share }, memory)
    }

    /// If a contact of a projection presses that friction does not know: takes the forces of all, and the contacts that press or come near.
    fn meet(&mut self, found: &ProjectionShare<D>) -> bool {
        let (view, problem) = (&found.view, found.view.problem(&self.share.problem));
        let forces: Vec<(&ContactForce<D>, Contact<D>)> =
            found.projection.forces.iter().map(|force| (force, view.numbered(&force.contact))).collect();
        let largest =
            forces.iter().map(|(force, _)| force.force).chain(self.wrenches.values().map(|wrench| wrench.force.norm())).fold(0.0, f64::max);
        let rounding = CANCELLATION * self.peers.max(largest);
        let is_new = |contact: &Contact<D>| !self.contacts.contains_key(&contact.identity());
        if !self.peers.any(forces.iter().any(|(force, contact)| force.force > rounding && is_new(contact))) {
            return false;
        }
        for (ContactForce { contact: seen, force, .. }, contact) in forces {
            if let Some(known) = self.wrenches.get_mut(&contact.identity()) {
                known.force += contact.normal * *force;
            } else if *force > 0.0 || problem.gap_after(seen, &view.velocities) < NEAR * seen.smaller_radius(problem.balls) {
                self.join(contact, contact.normal * *force);
            }
        }
        true
    }

    /// Finds the forces with friction, from those that are known.
    fn solve(&mut self) {
        let local = self.local_view(self.contacts.values().copied().collect(), self.share.problem.velocities);
        let LocalView { view, masses, twists, contacts } = &local;
        let guess = |identity: &Identity<D>| (self.wrenches[identity], !self.fresh.contains(identity));
        let shared = Shared { peers: self.peers, view, share: self.share, masses, twists, contacts };
        let (wrenches, cost) = shared.solve(self.friction, &guess);
        self.wrenches = wrenches;
        self.fresh.clear();
        self.cost = Cost { sweeps: self.cost.sweeps.max(cost.sweeps), iterations: self.cost.iterations.max(cost.iterations) };
        self.changes = self.changes_of(&local, &|contact| self.wrenches[&view.identity(contact)]);
    }

    /// How own bodies move with these velocities.
    fn motions<'b>(&self, velocities: &'b [SVector<f64, D>]) -> Motions<'b, D> {
        Motions { velocities, common: common_motion(self.peers, &self.share.problem, velocities) }
    }

    /// Bodies as they are and as they may move, with contacts of bodies by number.
    fn local_view(&self, known: Vec<Contact<D>>, velocities: &[SVector<f64, D>]) -> LocalView<D> {
        let (peers, problem) = (self.peers, &self.share.problem);
        let view = View::new(peers, self.share, &self.motions(velocities), 0.0, &known);
        let inertias = view.halo.spread(peers, self.friction.inertias);
        let masses = view.weights.iter().zip(inertias).map(|(weight, inertia)| [weight * self.friction.duration, inertia]).collect();
        let twists = view.halo.spread_twists(peers, problem.velocities, self.friction.spins);
        let contacts = known.iter().map(|contact| view.placed(contact)).collect();
        LocalView { view, masses, twists, contacts }
    }

    /// What wrenches at contacts change the motions of own bodies by.
    fn changes_of(
        &self,
        LocalView { view, masses, contacts, .. }: &LocalView<D>,
        wrench: &dyn Fn(&Contact<D>) -> ContactWrench<D>,
    ) -> Vec<Twist<D>> {
        let mut changes = vec![Twist::zero(); view.halo.len()];
        for contact in contacts {
            let (duration, ContactWrench { force, couple }) = (self.friction.duration, wrench(contact));
            let (frame, impulse) = (Frame::new(contact, &view.balls), force * duration);
            let tangential = frame.tangential(&frame.components(&impulse));
            let ends = [(Some(contact.body), -1.0, frame.arms[0]), (contact.other(), 1.0, -frame.arms[1])];
            for (body, sign, arm) in ends.into_iter().filter_map(|(body, sign, arm)| body.map(|body| (body, sign, arm))) {
                changes[body].velocity += impulse * (sign / masses[body][0]);
                changes[body].spin += (frame.torque(&(tangential * sign), arm) + couple * (sign * duration)) / masses[body][1];
            }
        }
        if let Some(wall) = self.share.problem.wall {
            wall.carry(&mut changes, |change| &mut change.velocity);
        }
        view.halo.own().iter().map(|&place| changes[place]).collect()
    }

    fn finish(self, found: ProjectionShare<D>) -> FrictionProjection<D> {
        let spins: Vec<SMatrix<f64, D, D>> =
            self.friction.spins.iter().zip(&self.changes).map(|(spin, change)| spin + change.spin).collect();
        let wrenches = self.whole_wrenches(&found);
        let local = self.local_view(wrenches.values().map(|(contact, _)| *contact).collect(), &found.projection.velocities);
        let ends = local.view.halo.spread_twists(self.peers, &found.projection.velocities, &spins);
        let whole = |contact: &Contact<D>| wrenches[&local.view.identity(contact)].1;
        let kkt_report = self.certify(&local, &ends, &whole, &found.projection.kkt_report);
        let forces = wrenches.into_values().map(|(contact, ContactWrench { force, .. })| {
            let normal = force.dot(&contact.normal);
            let tangential = if normal > 0.0 { force - contact.normal * normal } else { SVector::zeros() };
            ContactForce { contact, force: normal, tangential, couple: SMatrix::zeros() }
        });
        FrictionProjection { velocities: found.projection.velocities, spins, forces: forces.collect(), kkt_report }
    }

    /// Wrenches of all contacts of own bodies, of bodies by number: those found with friction and the normal forces of the last change.
    fn whole_wrenches(&self, found: &ProjectionShare<D>) -> BTreeMap<Identity<D>, (Contact<D>, ContactWrench<D>)> {
        let mut wrenches: BTreeMap<Identity<D>, (Contact<D>, ContactWrench<D>)> =
            self.contacts.iter().map(|(identity, contact)| (*identity, (*contact, self.wrenches[identity]))).collect();
        for force in &found.projection.forces {
            let contact = found.view.numbered(&force.contact);
            wrenches.entry(contact.identity()).or_insert((contact, ContactWrench::zero())).1.force += contact.normal * force.force;
        }
        wrenches
    }

    /// How good whole wrenches and the motions at the end are. Collective.
    fn certify(
        &self,
        local: &LocalView<D>,
        ends: &[Twist<D>],
        whole: &dyn Fn(&Contact<D>) -> ContactWrench<D>,
        found: &KktReport,
    ) -> KktReport {
        let LocalView { view, masses, twists, contacts } = local;
        let (peers, Problem { domain, step, .. }) = (self.peers, self.share.problem);
        let normals: Vec<ContactForce<D>> =
            contacts.iter().map(|contact| ContactForce::normal(*contact, whole(contact).force.dot(&contact.normal))).collect();
        let sides = |contact: &Contact<D>| {
            let ContactWrench { force, couple } = whole(contact);
            ContactWrench { force: force - contact.normal * force.dot(&contact.normal), couple }
        };
        let rubbed = self.changes_of(local, &sides);
        let wanted: Vec<SVector<f64, D>> =
            self.share.problem.velocities.iter().zip(rubbed).map(|(wanted, change)| wanted + change.velocity).collect();
        let problem = Problem { velocities: &view.halo.spread_vectors(peers, &wanted), ..view.problem(&self.share.problem) };
        let report = kkt_report::certify(peers, view, &problem, &normals, &[]);
        let Cost { sweeps, iterations } = self.cost;
        let tolerance = FrictionReport::tolerance_of(self.friction.tolerance);
        let mut friction = FrictionReport { sweeps, iterations, tolerance, ..FrictionReport::default() };
        let FrictionShare { surfaces, duration, starts, .. } = *self.friction;
        let (velocities, spins): (Vec<_>, Vec<_>) = starts.iter().map(|start| (start.velocity, start.spin)).unzip();
        let (starts, wall) = (&view.halo.spread_twists(peers, &velocities, &spins), self.share.problem.wall);
        let certified = Certified { domain, view, masses, starts, twists, ends, contacts, step, duration, surfaces, wall };
        certify(peers, &certified, whole, &mut friction);
        let KktReport { smallest_gap, iterations, solver, rounds, largest_island, .. } = *found;
        KktReport { smallest_gap, iterations, solver, rounds, largest_island, friction: Some(friction), ..report }
    }
}
