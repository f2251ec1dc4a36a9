//! The rules by which bodies in a flow travel over a step, before contacts are kept: two-step, midpoint and Euler's.

use nalgebra::SVector;

use super::{
    quasi_static::QuasiStatic,
    stepper::{Effort, Observation},
};
use crate::{
    body::Twist,
    contact::{ContactForce, Partner, bodies_of},
    error::Result,
    interaction::Interactions,
    mechanics::starts_at_once,
    scene::Scheme,
    setup::{ContactHistory, State},
    system::ResidualMonitor,
};

/// Radii that a contact closes by in an impact, at least.
const CLOSED: f64 = 1e-6;

impl<const D: usize> QuasiStatic<D> {
    /// The motions by which bodies travel before contacts are kept.
    pub(super) fn rule(
        &mut self,
        state: &State<D>,
        observation: &Observation<D>,
        length: f64,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Vec<Twist<D>>> {
        match self.step_control.time.scheme {
            Scheme::Euler => Ok(observation.twists.clone()),
            _ if self.starts(state) => {
                let mut moves = observation.twists.clone();
                self.follow_images(state, length, 0.0, &mut moves);
                Ok(moves)
            }
            Scheme::TwoStep if self.last_step(state) > 0.0 => {
                let factor = self.looks_back(state, length);
                let impacts = if self.evolves() { self.impacts(state, observation) } else { Vec::new() };
                let jumps = jumps(state, observation, &impacts, &self.suspension.setup().interactions);
                let mut moves = two_step(state, observation, factor, &jumps);
                self.follow_images(state, length, factor, &mut moves);
                Ok(moves)
            }
            _ => self.midpoint(state, observation, length, effort, monitor),
        }
    }

    /// The part of the change of motions over the last step that the two-step rule adds to those of a step of this length. In a flow with inertia the second step makes up
    /// for the first one, which knew the motions of the start only: from there they go along straight lines, or have jumped at once.
    pub(super) fn looks_back(&self, state: &State<D>, length: f64) -> f64 {
        let ratio = length / state.last_step;
        match self.evolves() && state.steps == 1 {
            true if starts_at_once(self.suspension.setup()) => 1.0 / ratio,
            true => 0.5 * (ratio + 1.0 / ratio),
            false => 0.5 * ratio,
        }
    }

    /// Bodies with inertia whose contacts closed in the last step: an impulse stopped them, and what they looked back to would part them again.
    fn impacts(&self, state: &State<D>, observation: &Observation<D>) -> Vec<usize> {
        let velocities: Vec<SVector<f64, D>> = state.bodies.iter().map(|body| body.twist.velocity).collect();
        let balls = state.balls(&self.radii);
        let closed = |active: &&ContactForce<D>| {
            let (contact, way) = (&active.contact, active.contact.opening(&velocities) * state.last_step);
            active.force > 0.0 && way < -CLOSED * contact.smaller_radius(&balls)
        };
        observation.contacts.iter().filter(closed).flat_map(|active| bodies_of(active.contact.identity())).collect()
    }

    /// Motions half a step ahead.
    fn midpoint(
        &mut self,
        state: &State<D>,
        observation: &Observation<D>,
        length: f64,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Vec<Twist<D>>> {
        let half = 0.5 * length;
        let mut ahead = state.clone();
        ahead.advance(&observation.twists, half);
        ahead.bodies.iter_mut().zip(&observation.twists).for_each(|(body, twist)| body.twist = *twist);
        ahead.contact_history = observation.contacts.iter().map(ContactHistory::of).collect();
        ahead.adhesive_contacts = self.remembered(&self.placed(state), &observation.contacts, half);
        Ok(self.agree(&ahead, None, effort, monitor)?.twists)
    }
}

/// Whether velocities of bodies jumped: those that an impact stopped, those that came into contact or out of it since the last step, if contact forces
/// jump, and what is tied to them.
fn jumps<const D: usize>(state: &State<D>, observation: &Observation<D>, impacts: &[usize], interactions: &Interactions<D>) -> Vec<bool> {
    let now: Vec<ContactHistory<D>> = observation.contacts.iter().filter(|active| active.force != 0.0).map(ContactHistory::of).collect();
    let (before, after) = (contacts_of(&state.contact_history, state.bodies.len()), contacts_of(&now, state.bodies.len()));
    let mut jumps: Vec<bool> = before.iter().zip(&after).map(|(before, after)| interactions.projects() && before != after).collect();
    impacts.iter().for_each(|&body| jumps[body] = true);
    for cluster in interactions.clusters() {
        let any = jumps[cluster.bodies.clone()].contains(&true);
        jumps[cluster.bodies.clone()].fill(any);
    }
    jumps
}

/// `v + factor (v - v_last)`; bodies whose velocities jumped do not look back.
fn two_step<const D: usize>(state: &State<D>, observation: &Observation<D>, factor: f64, jumps: &[bool]) -> Vec<Twist<D>> {
    let rule = |(body, (now, last)): (usize, (&Twist<D>, &Twist<D>))| {
        if jumps[body] {
            return *now;
        }
        Twist { velocity: now.velocity + (now.velocity - last.velocity) * factor, spin: now.spin + (now.spin - last.spin) * factor }
    };
    observation.twists.iter().zip(state.bodies.iter().map(|body| &body.twist)).enumerate().map(rule).collect()
}

/// For each body its contacts, seen from it.
fn contacts_of<const D: usize>(contact_history: &[ContactHistory<D>], bodies: usize) -> Vec<Vec<(Partner, [i32; D])>> {
    let mut of_body = vec![Vec::new(); bodies];
    for contact in contact_history {
        of_body[contact.body].push((contact.partner, contact.image));
        if let Partner::Body(partner) = contact.partner {
            of_body[partner].push((Partner::Body(contact.body), contact.image.map(|image| -image)));
        }
    }
    of_body.iter_mut().for_each(|contacts| contacts.sort_unstable());
    of_body
}
