//! Velocities and spins that keep contacts with friction: frictionless contacts are found first; then friction and, with its tangential forces as known ones,
//! the frictionless program in turn, until that finds no contact that friction does not know. So nothing overlaps, however well friction was solved.

use std::collections::BTreeMap;

use nalgebra::{SMatrix, SVector};

use super::{
    FrictionProjection, FrictionShare,
    certificate::{Certified, certify},
    frame::Frame,
    islands::{Cost, Forces, Shared},
};
use crate::{
    body::Twist,
    contact::{
        Contact, ContactForce, FrictionReport, Identity, KktReport, Memory, Problem, ProblemShare, ProjectionShare, View,
        paths::{Motions, common_motion},
        project_share,
    },
    error::Result,
    linalg::CANCELLATION,
    parallel::Peers,
};

/// Times that contacts are added before the forces are taken as they are.
const ROUNDS: usize = 20;

/// Where the rounds stand on a rank.
struct Rounds<'a, const D: usize> {
    peers: Peers<'a>,
    share: &'a ProblemShare<'a, D>,
    friction: &'a FrictionShare<'a, D>,
    /// All contacts of own bodies that friction knows, of bodies by number.
    contacts: BTreeMap<Identity<D>, Contact<D>>,
    forces: Forces<D>,
    /// What tangential forces change the motions of own bodies by.
    changes: Vec<Twist<D>>,
    cost: Cost,
}

/// Bodies that are seen.
struct Seen<const D: usize> {
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
    let mut rounds = Rounds::new(peers, share, friction);
    let mut found = rounds.separate(memory)?;
    for _ in 0..ROUNDS {
        if !rounds.meet(&found) {
            break;
        }
        rounds.solve(memory);
        found = rounds.separate(&rounds.normal_forces())?;
    }
    Ok(rounds.finish(found))
}

impl<'a, const D: usize> Rounds<'a, D> {
    fn new(peers: Peers<'a>, share: &'a ProblemShare<'a, D>, friction: &'a FrictionShare<'a, D>) -> Self {
        let changes = vec![Twist::zero(); friction.spins.len()];
        Rounds { peers, share, friction, contacts: BTreeMap::new(), forces: BTreeMap::new(), changes, cost: Cost::default() }
    }

    /// The frictionless velocities next to those wanted and changed by tangential forces.
    fn separate(&self, memory: &Memory<D>) -> Result<ProjectionShare<D>> {
        let wanted = self.share.problem.velocities.iter().zip(&self.changes);
        let velocities: Vec<SVector<f64, D>> = wanted.map(|(wanted, change)| wanted + change.velocity).collect();
        let problem = Problem { velocities: &velocities, ..self.share.problem };
        project_share(self.peers, &ProblemShare { problem, ..*self.share }, memory)
    }

    /// Takes the contacts of a projection, if one of them presses that friction does not know.
    fn meet(&mut self, found: &ProjectionShare<D>) -> bool {
        let forces = &found.projection.forces;
        let rounding = CANCELLATION * self.peers.max(forces.iter().map(|force| force.force).fold(0.0, f64::max));
        let numbered: Vec<(Contact<D>, f64)> = forces.iter().map(|force| (found.view.numbered(&force.contact), force.force)).collect();
        let is_new = |(contact, force): &(Contact<D>, f64)| *force > rounding && !self.contacts.contains_key(&contact.identity());
        let learned = self.peers.any(numbered.iter().any(is_new));
        if learned {
            self.contacts.extend(numbered.into_iter().map(|(contact, _)| (contact.identity(), contact)));
        }
        learned
    }

    /// Finds the forces with friction, from those found last or else those of the last step.
    fn solve(&mut self, memory: &Memory<D>) {
        let seen = self.look();
        let Seen { view, masses, twists, contacts } = &seen;
        let guess = |identity: &Identity<D>| match self.forces.get(identity) {
            Some(held) => held.force,
            None => {
                self.contacts[identity].normal * memory.force(identity)
                    + self.friction.last.get(identity).copied().unwrap_or_else(SVector::zeros)
            }
        };
        let shared = Shared { peers: self.peers, view, share: self.share, masses, twists, contacts };
        let (forces, cost) = shared.solve(self.friction, &guess);
        self.forces = forces;
        self.cost = Cost { sweeps: self.cost.sweeps.max(cost.sweeps), iterations: self.cost.iterations.max(cost.iterations) };
        self.changes = self.changes_of(&seen);
    }

    /// Bodies as they are, with what is known of the contacts.
    fn look(&self) -> Seen<D> {
        let (peers, problem) = (self.peers, &self.share.problem);
        let motions = Motions { velocities: problem.velocities, common: common_motion(peers, problem, problem.velocities) };
        let known: Vec<Contact<D>> = self.contacts.values().copied().collect();
        let view = View::new(peers, self.share, &motions, 0.0, &known);
        let inertias = view.halo.spread(peers, self.friction.inertias);
        let masses = view.weights.iter().zip(inertias).map(|(weight, inertia)| [weight * problem.step, inertia]).collect();
        let twists = view.halo.spread_twists(peers, problem.velocities, self.friction.spins);
        let contacts = known.iter().map(|contact| view.placed(contact)).collect();
        Seen { view, masses, twists, contacts }
    }

    /// What the tangential forces change the motions of own bodies by.
    fn changes_of(&self, Seen { view, masses, contacts, .. }: &Seen<D>) -> Vec<Twist<D>> {
        let mut changes = vec![Twist::zero(); view.halo.len()];
        for contact in contacts {
            let (frame, force) = (Frame::new(contact, &view.balls), self.forces[&view.identity(contact)].force);
            let impulse = frame.tangential(&frame.components(&force)) * self.share.problem.step;
            let ends = [(Some(contact.body), -impulse, frame.arms[0]), (contact.other(), impulse, -frame.arms[1])];
            for (body, impulse, arm) in ends.into_iter().filter_map(|(body, impulse, arm)| body.map(|body| (body, impulse, arm))) {
                changes[body].velocity += impulse / masses[body][0];
                changes[body].spin += frame.torque(&impulse, arm) / masses[body][1];
            }
        }
        view.halo.own().iter().map(|&place| changes[place]).collect()
    }

    /// The normal forces that were found, to start from.
    fn normal_forces(&self) -> Memory<D> {
        self.contacts.iter().map(|(identity, contact)| (*identity, self.normal_force(contact))).collect()
    }

    fn normal_force(&self, contact: &Contact<D>) -> f64 {
        self.forces.get(&contact.identity()).map_or(0.0, |held| held.force.dot(&contact.normal).max(0.0))
    }

    fn finish(self, found: ProjectionShare<D>) -> FrictionProjection<D> {
        let spins: Vec<SMatrix<f64, D, D>> =
            self.friction.spins.iter().zip(&self.changes).map(|(spin, change)| spin + change.spin).collect();
        let forces = self.normals(&found);
        let velocities = found.projection.velocities;
        let mut report = FrictionReport { sweeps: self.cost.sweeps, iterations: self.cost.iterations, ..FrictionReport::default() };
        if self.peers.any(!self.contacts.is_empty()) {
            let Seen { view, masses, twists, contacts } = self.look();
            let ends = view.halo.spread_twists(self.peers, &velocities, &spins);
            let force = |identity: &Identity<D>| self.whole_force(identity, &forces);
            let (domain, step) = (self.share.problem.domain, self.share.problem.step);
            let coefficient = self.friction.coefficient;
            let certified =
                Certified { domain, view: &view, masses: &masses, twists: &twists, ends: &ends, contacts: &contacts, step, coefficient };
            certify(self.peers, &certified, &force, &mut report);
        }
        let forces = forces.into_values().map(|force| self.with_side(force)).collect();
        let kkt_report = KktReport { friction: Some(report), ..found.projection.kkt_report };
        FrictionProjection { velocities, spins, forces, kkt_report }
    }

    /// Normal forces of all contacts: those found with friction where that was solved, else those that keep bodies apart.
    fn normals(&self, found: &ProjectionShare<D>) -> BTreeMap<Identity<D>, ContactForce<D>> {
        let apart = found.projection.forces.iter().map(|force| ContactForce { contact: found.view.numbered(&force.contact), ..*force });
        let mut normals: BTreeMap<Identity<D>, ContactForce<D>> = apart.map(|force| (force.contact.identity(), force)).collect();
        for (identity, contact) in &self.contacts {
            if self.forces.get(identity).is_none_or(|held| held.is_solved) {
                normals.insert(*identity, ContactForce::normal(*contact, self.normal_force(contact)));
            }
        }
        normals
    }

    fn whole_force(&self, identity: &Identity<D>, normals: &BTreeMap<Identity<D>, ContactForce<D>>) -> SVector<f64, D> {
        let contact = &self.contacts[identity];
        contact.normal * normals.get(identity).map_or(0.0, |force| force.force) + self.side(identity)
    }

    /// The tangential force of a contact.
    fn side(&self, identity: &Identity<D>) -> SVector<f64, D> {
        let (contact, held) = (&self.contacts[identity], self.forces.get(identity));
        held.map_or_else(SVector::zeros, |held| held.force - contact.normal * held.force.dot(&contact.normal))
    }

    /// The force of a contact with its tangential part, if it presses.
    fn with_side(&self, force: ContactForce<D>) -> ContactForce<D> {
        let identity = force.contact.identity();
        let presses = force.force > 0.0 && self.contacts.contains_key(&identity);
        if presses { ContactForce { tangential: self.side(&identity), ..force } } else { force }
    }
}
