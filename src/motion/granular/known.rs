//! What follows from where granular bodies are and how they move, before anything is projected.

use std::ops::Range;

use nalgebra::SVector;

use super::{
    Granular, Known,
    migration::Constants,
    ties::Ties,
    velocities::{Acceleration, HalfStepBehind},
};
use crate::{
    body::{Halo, Twist},
    contact::{ContactForce, KktReport},
    motion::step_control::BodyMotion,
    parallel::Peers,
    setup::{Moving, State},
};

impl<const D: usize> Granular<D> {
    /// The forces that interactions know from where bodies are, and accelerations by all forces but those that a projection finds.
    pub(super) fn known(&self, state: &State<D>) -> Known<D> {
        // nobody looks beyond the own bodies where nothing acts at a distance
        let peers = if self.reach > 0.0 { self.peers() } else { Peers::Alone };
        let near = self.neighbours(peers, state, &[]);
        let arrangement = near.arrangement(&self.domain, self.reach, state.time);
        let forces = self.interactions.forces(&arrangement);
        let (pushes, contacts) = (forces.on_bodies(near.halo.len(), &[]), forces.contacts);
        let accelerations = self.bodies.iter().zip(near.halo.own()).map(|(body, &place)| Acceleration::of(body, &pushes[place])).collect();
        let reported: Vec<ContactForce<D>> = contacts.iter().filter(|force| near.halo.owns(force.contact.body)).copied().collect();
        let kkt_report = Some(KktReport::of_forces(&reported, arrangement.balls).over(self.peers()));
        Known { contacts: near.own_contacts(contacts), kkt_report, accelerations, twists: Vec::new() }
    }

    /// Forces of springs of chains on own bodies; none without chains. Collective.
    fn pulls_of_bonds(&self, state: &State<D>) -> Vec<SVector<f64, D>> {
        let chains: Vec<Range<usize>> = self.interactions.chains();
        if chains.is_empty() {
            return Vec::new();
        }
        let own = |chain: &Range<usize>| chain.clone().any(|body| state.place(body).is_some());
        let (peers, chains) = (self.peers(), chains.into_iter().filter(own).collect::<Vec<_>>());
        let halo = Halo::of_numbers(peers, &state.numbers(), chains.iter().cloned().flatten());
        let balls = halo.spread_balls(peers, &state.balls(&self.radii));
        let center = |body: usize| balls[halo.place(body).expect("bodies of own chains are seen")].center;
        let mut pulls = vec![SVector::zeros(); state.bodies.len()];
        for spring in
            chains.iter().flat_map(|chain| self.interactions.springs_of(chain, &center)).filter(|spring| spring.stiffness.is_finite())
        {
            for (body, gradient) in &spring.ends {
                state.place(*body).into_iter().for_each(|place| pulls[place] -= gradient * (spring.stiffness * spring.value));
            }
        }
        pulls
    }

    /// The motions of own bodies at the time of a state. Collective.
    pub(super) fn carried_on(&self, state: &State<D>) -> Vec<Twist<D>> {
        let (peers, bodies) = (self.peers(), &self.bodies);
        let behind = HalfStepBehind::new(peers, state, bodies, &self.known.accelerations, &self.groups, self.lag(state));
        let mut twists = behind.carried_on();
        if !self.interactions.clusters().is_empty() {
            Ties::turn_clusters_on(peers, &self.interactions, state, bodies, &behind.pushed(), &mut twists);
        }
        self.trajectories
            .twists(state.time)
            .for_each(|(body, twist)| state.place(body).into_iter().for_each(|place| twists[place] = twist));
        twists
    }

    /// How own bodies move, their surfaces by rotation, and the wall under a load, of which steps are chosen. Collective.
    pub(super) fn motions(&self, state: &State<D>) -> Vec<BodyMotion<D>> {
        let pulls = if state.last_step > 0.0 { Vec::new() } else { self.pulls_of_bonds(state) };
        let moving = state.bodies.iter().zip(&self.known.accelerations).zip(&self.radii).enumerate();
        let wall = self.wall.as_ref().zip(state.wall).map(|(pressed, wall)| pressed.motion(&wall, state.last_step));
        moving
            // velocities live half a step before places
            .map(|(place, ((body, acceleration), &radius))| BodyMotion {
                radius,
                velocity: body.twist.velocity + acceleration.velocity * (0.5 * state.last_step),
                acceleration: pulls.get(place).map_or(acceleration.velocity, |pull| acceleration.velocity + pull / self.bodies[place].mass),
            })
            .chain(wall)
            .chain(self.turns(state))
            .collect()
    }

    /// How surfaces of own bodies move by rotation, where that changes: by torques, or where surfaces rub.
    fn turns(&self, state: &State<D>) -> Vec<BodyMotion<D>> {
        let rubs = self.interactions.friction().is_some();
        let along = |size: f64| SVector::from_fn(|axis, _| if axis == 0 { size } else { 0.0 });
        let turn = |((body, acceleration), &radius): ((&Moving<D>, &Acceleration<D>), &f64)| {
            let [spin, spin_up] = [body.twist.spin, acceleration.spin].map(|spin| spin.norm() * std::f64::consts::FRAC_1_SQRT_2);
            let motion = BodyMotion { radius, velocity: along(spin * radius), acceleration: along(spin_up * radius) };
            (spin_up > 0.0 || rubs && spin > 0.0).then_some(motion)
        };
        state.bodies.iter().zip(&self.known.accelerations).zip(&self.radii).filter_map(turn).collect()
    }

    /// Kinetic energy of own bodies that forces move, with these motions.
    pub(super) fn kinetic_energy(&self, twists: &[Twist<D>]) -> f64 {
        let of_body = |(own, twist): (&Constants<D>, &Twist<D>)| {
            // a skew matrix has each component of the spin twice
            let turning = 0.5 * own.inertia * twist.spin.norm_squared();
            0.5 * (own.mass * twist.velocity.norm_squared() + turning)
        };
        self.bodies.iter().zip(twists).filter(|(own, _)| own.mass.is_finite()).map(of_body).sum()
    }
}
