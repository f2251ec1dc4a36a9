//! Contacts and ties of a step: velocities that keep both, next to those wanted.

use std::{borrow::Cow, ops::Range};

use nalgebra::SVector;

use super::{
    Granular,
    chains::{Accelerated, GranularStep},
    migration,
    ties::Ties,
    together::{Together, Wanting},
    velocities,
};
use crate::{
    body::{Halo, Twist},
    contact::{self, AdhesiveContact, Contact, ContactForce, Problem, ProblemShare, ProjectionShare, bodies_of, renamed},
    error::{Error, Result},
    geometry::Ball,
    interaction::Arrangement,
    petsc::{Stage, enter},
    setup::State,
};

/// Rounds that bonds and contacts are given to agree.
const MOST_ROUNDS: usize = 2000;

/// Rounds after which bonds and contacts are solved at once to start again; after others they go on in turn.
const AT_ONCE: Range<usize> = 0..50;

/// Part of a length, an area or a volume that chains and cells may miss after a step.
const LARGEST_MISSED: f64 = 1e-6;

/// Difference between the places that bonds and contacts want after a step, in radii of the smallest body, that counts as agreement.
const AGREEMENT: f64 = 1e-7;

/// Velocities that keep contacts and ties.
pub(super) struct Kept<const D: usize> {
    pub projection: ProjectionShare<D>,
    /// What contacts remember then.
    pub adhesive_contacts: Vec<AdhesiveContact<D>>,
    /// What contacts change the wanted velocities by that ties are next to; empty without ties.
    pub changes: Vec<SVector<f64, D>>,
}

impl<const D: usize> Granular<D> {
    /// Velocities that keep contacts, next to those wanted, and what contacts remember then.
    fn project(
        &self,
        state: &State<D>,
        moves: &[Twist<D>],
        lower_bounds: &[ContactForce<D>],
        GranularStep { length: step, push }: GranularStep,
    ) -> Result<(ProjectionShare<D>, Vec<AdhesiveContact<D>>)> {
        let (_stage, peers) = (enter(Stage::Contacts), self.peers());
        let balls: Vec<Ball<D>> = state.balls(&self.radii);
        let weights: Vec<f64> = self.bodies.iter().map(|body| body.mass / push).collect();
        let velocities: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
        let numbers = state.numbers();
        let problem = Problem {
            numbers: Some(&numbers),
            lower_bounds,
            cluster_of: self.interactions.cluster_of(),
            ..Problem::new(&self.domain, &balls, &weights, &velocities, step)
        };
        let found = contact::project_share(
            peers,
            &ProblemShare { problem, regions: &self.regions, spanning: (&self.session).into() },
            &state.memory(),
        )?;
        let masses: Vec<f64> = found.view.weights.iter().map(|weight| weight * push).collect();
        let (domain, numbers) = (&self.domain, Some(found.view.halo.numbers()));
        let arrangement =
            Arrangement { domain, numbers, balls: &found.view.balls, weights: &masses, viscosity: None, reach: 0.0, time: state.time };
        let remember = |adhesive_contacts: &[_], forces: &[_]| self.interactions.remember(&arrangement, adhesive_contacts, forces, push);
        let remembered = migration::remembered(peers, &found, &state.adhesive_contacts, remember);
        Ok((found, remembered))
    }

    /// Velocities that keep contacts and ties, next to those wanted.
    pub(super) fn keep_apart(
        &self,
        state: &State<D>,
        ties: Option<&mut Ties<D>>,
        moves: &[Twist<D>],
        rubbed: Option<&[Twist<D>]>,
        step: GranularStep,
    ) -> Result<Kept<D>> {
        let lower_bounds = self.lower_bounds(state, step.push);
        let Some(ties) = ties else {
            let (projection, adhesive_contacts) = self.project(state, moves, &lower_bounds, step)?;
            return Ok(Kept { projection, adhesive_contacts, changes: Vec::new() });
        };
        self.keep_ties(state, ties, moves, rubbed, &lower_bounds, step)
    }

    /// The same in turn with ties, until both agree.
    fn keep_ties(
        &self,
        state: &State<D>,
        ties: &mut Ties<D>,
        moves: &[Twist<D>],
        rubbed: Option<&[Twist<D>]>,
        lower_bounds: &[ContactForce<D>],
        step: GranularStep,
    ) -> Result<Kept<D>> {
        let wanted = velocities(moves);
        let (peers, mut target) = (self.peers(), moves.to_vec());
        let smallest = peers.min(self.radii.iter().copied().fold(f64::INFINITY, f64::min));
        let guess = if rubbed.is_some() { vec![SVector::zeros(); moves.len()] } else { self.by_last_contacts(state, step.push) };
        let (mut contacts, mut apart) = (Accelerated::new(guess), f64::INFINITY);
        let mut together = Together::default();
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                self.stop.heed(self.session.world(), state.time)?;
            }
            let changes = with_friction(&contacts.ahead, rubbed);
            let tied = ties.hold(peers, &wanted, &changes);
            target.iter_mut().zip(tied.iter().zip(&contacts.ahead)).for_each(|(twist, (tied, ahead))| twist.velocity = tied - ahead);
            let (projection, adhesive_contacts) = self.project(state, &target, lower_bounds, step)?;
            let kept = &projection.projection.velocities;
            let difference = kept.iter().zip(&tied).map(|(kept, tied)| (kept - tied).norm()).fold(0.0, f64::max);
            apart = -peers.min(-difference) * step.length;
            if apart <= AGREEMENT * smallest {
                return Ok(Kept { projection, adhesive_contacts, changes: changes.into_owned() });
            }
            together.meet(&projection, lower_bounds);
            let at_once = if AT_ONCE.contains(&round) {
                self.changes_at_once(state, step, [&with_friction(&wanted, rubbed), &contacts.ahead], &tied, &together, ties)
            } else {
                None
            };
            contacts.advance(peers, kept.iter().zip(&target).map(|(kept, target)| kept - target.velocity).collect(), &self.masses());
            contacts = at_once.map_or(contacts, Accelerated::new);
        }
        Err(disagreement(state.time, step.length, apart))
    }

    /// What contacts change wanted velocities by where they and ties are solved at once, from changes of which ties have made those held. Collective.
    fn changes_at_once(
        &self,
        state: &State<D>,
        step: GranularStep,
        wanted: [&[SVector<f64, D>]; 2],
        held: &[SVector<f64, D>],
        together: &Together<D>,
        ties: &Ties<D>,
    ) -> Option<Vec<SVector<f64, D>>> {
        let (peers, numbers, balls, masses) = (self.peers(), state.numbers(), state.balls(&self.radii), self.masses());
        let weights: Vec<f64> = masses.iter().map(|mass| mass / step.push).collect();
        let (velocities, clusters) = ties.linear(peers, wanted, held, &weights);
        let own = Wanting { domain: &self.domain, numbers: &numbers, balls: &balls, masses: &masses, velocities: &velocities, step };
        together.changes(peers, &own, ties, &clusters)
    }

    /// Refuses a step in which bonds miss a length, an area or a volume that stays as it is. Collective.
    pub(super) fn refuse_missed(&self, time: f64, step: f64, ties: &Ties<D>) -> Result<()> {
        let missed = -self.peers().min(-ties.missed());
        if missed <= LARGEST_MISSED {
            return Ok(());
        }
        let text = format!(
            "at time {time} a rod misses its length, or a cell its area or volume, by a part of {missed:.1e}; choose a shorter time.step, or \"auto\""
        );
        Err(Error::StepTooLong { text, step })
    }

    /// What the contact forces of the last step would change velocities by. Collective.
    fn by_last_contacts(&self, state: &State<D>, push: f64) -> Vec<SVector<f64, D>> {
        let (peers, numbers) = (self.peers(), state.numbers());
        let halo = Halo::of_numbers(peers, &numbers, state.contact_history.iter().flat_map(|contact| bodies_of(contact.identity())));
        let balls = halo.spread_balls(peers, &state.balls(&self.radii));
        let mut changes = vec![SVector::zeros(); halo.len()];
        for history in &state.contact_history {
            let identity = renamed(history.identity(), |number| halo.place(number).expect("bodies of contacts are seen"));
            let contact = Contact::again(&self.domain, &balls, identity);
            let push = contact.normal * (history.force * push);
            changes[contact.body] -= push;
            if let Some(other) = contact.other() {
                changes[other] += push;
            }
        }
        halo.own().iter().zip(&self.bodies).map(|(&place, body)| changes[place] / body.mass).collect()
    }

    /// Contacts of own bodies that may pull, each with the least force that it may bear; bodies are named by their numbers.
    fn lower_bounds(&self, state: &State<D>, push: f64) -> Vec<ContactForce<D>> {
        if !self.peers().any(!state.adhesive_contacts.is_empty()) {
            return Vec::new();
        }
        let near = self.neighbours(self.peers(), state, &state.adhesive_contacts);
        let bounds = self.interactions.lower_bounds(&near.arrangement(&self.domain, self.reach, state.time), &near.adhesive_contacts, push);
        near.own_contacts(bounds)
    }
}

/// Changes, with those by friction if there is any.
fn with_friction<'a, const D: usize>(changes: &'a [SVector<f64, D>], rubbed: Option<&[Twist<D>]>) -> Cow<'a, [SVector<f64, D>]> {
    match rubbed {
        Some(rubbed) => changes.iter().zip(rubbed).map(|(change, rubbed)| change + rubbed.velocity).collect(),
        None => Cow::Borrowed(changes),
    }
}

fn disagreement(time: f64, step: f64, apart: f64) -> Error {
    let text = format!(
        "at time {time} contacts do not agree with bonds and rigid clusters after {MOST_ROUNDS} rounds (places differ by {apart:.1e}); a shorter \
         time.step or softer chains may help"
    );
    Error::StepTooLong { text, step }
}
