//! Bodies without a fluid: contacts and ties, projected on velocities with which nothing overlaps.

mod all_bodies;
mod chains;
mod clusters;
mod friction;
mod given;
mod kept;
mod known;
mod loaded_wall;
pub(super) mod migration;
mod neighbours;
mod pressed_wall;
mod rubbing;
mod setup;
mod ties;
mod together;
mod velocities;
mod with_ties;

pub use setup::{GranularBody, GranularSetup, WallLoad};

use std::time::Instant;

use nalgebra::SVector;

use self::{chains::GranularStep, migration::Constants, neighbours::Neighbours, pressed_wall::PressedWall, velocities::Acceleration};
use super::{
    step_control::{StepControl, StepLimits, StepStart},
    stepper::{Observation, StepOutcome, Stepper, StepperView},
    stop_request::StopRequest,
};
use crate::{
    body::{Regions, Trajectories, Twist},
    contact::{AdhesiveContact, ContactForce, KktReport},
    dimension::same,
    error::{Error, Result},
    geometry::Domain,
    interaction::Interactions,
    parallel::Peers,
    petsc::Session,
    scene::Scheme,
    setup::{Moving, State},
    system::ResidualMonitor,
};

/// Granular bodies in motion, each with the rank in whose part of the box its centre lies.
pub struct Granular<const D: usize> {
    session: Session,
    domain: Domain<D>,
    regions: Regions<D>,
    interactions: Interactions<D>,
    step_control: StepControl,
    trajectories: Trajectories<D>,
    /// What stays the same of the own bodies.
    bodies: Vec<Constants<D>>,
    radii: Vec<f64>,
    /// How far interactions look, for bodies of any rank.
    reach: f64,
    /// Places and motions at the start of all bodies whose motion is given.
    given: Vec<(usize, SVector<f64, D>, Twist<D>)>,
    /// Of each body that is tied the number of what it belongs to.
    groups: Vec<Option<usize>>,
    /// The wall that a load presses on the bodies, if there is one.
    wall: Option<PressedWall>,
    /// In the state that was looked at last.
    known: Known<D>,
    stop: StopRequest,
}

/// What follows from where bodies are.
#[derive(Default)]
struct Known<const D: usize> {
    /// Contact forces on own bodies, which are named by their numbers, and what there is to say of those of all ranks.
    contacts: Vec<ContactForce<D>>,
    kkt_report: Option<KktReport>,
    /// Accelerations by all forces but those that a projection finds.
    accelerations: Vec<Acceleration<D>>,
    /// Motions of own bodies at the time of the state.
    twists: Vec<Twist<D>>,
}

/// What moves granular bodies with a step control, and the state of this rank at the start. Collective.
pub(super) fn stepper<const D: usize>(
    session: &Session,
    setup: GranularSetup<D>,
    step_control: StepControl,
) -> (Box<dyn Stepper<D>>, State<D>) {
    match D {
        2 => same(in_plane(session, same(setup), step_control)),
        _ => same(in_space(session, same(setup), step_control)),
    }
}

fn in_plane(session: &Session, setup: GranularSetup<2>, step_control: StepControl) -> (Box<dyn Stepper<2>>, State<2>) {
    let (stepper, state) = Granular::start(session, setup, step_control);
    (Box::new(stepper), state)
}

fn in_space(session: &Session, setup: GranularSetup<3>, step_control: StepControl) -> (Box<dyn Stepper<3>>, State<3>) {
    let (stepper, state) = Granular::start(session, setup, step_control);
    (Box::new(stepper), state)
}

impl<const D: usize> Granular<D> {
    /// Granular bodies that move with a step control, and the state of this rank at the start. Collective.
    pub fn start(session: &Session, setup: GranularSetup<D>, step_control: StepControl) -> (Granular<D>, State<D>) {
        let peers = Peers::from(session.world());
        let regions = Regions::new(&setup.domain, peers.count());
        let reach = setup.interactions.reach(setup.bodies.iter().map(|body| body.radius).fold(0.0, f64::max));
        let (own, state) = migration::own_share(peers, &setup, &regions);
        let given = setup.bodies.iter().enumerate().filter(|(_, body)| body.mass.is_infinite());
        let given = given.map(|(number, body)| (number, body.center, body.twist)).collect();
        let groups = setup.interactions.group_of();
        let smallest = setup.bodies.iter().map(|body| body.radius).fold(f64::INFINITY, f64::min);
        let wall = setup.load.map(|load| PressedWall::new(load, &setup.domain.size, smallest));
        let mut granular = Granular {
            session: session.clone(),
            domain: setup.domain,
            regions,
            interactions: setup.interactions,
            step_control,
            trajectories: setup.trajectories,
            radii: Vec::new(),
            bodies: own,
            reach,
            given,
            groups,
            wall,
            known: Known::default(),
            stop: StopRequest::default(),
        };
        granular.list_radii();
        (granular, state)
    }

    fn peers(&self) -> Peers<'_> {
        Peers::from(self.session.world())
    }

    fn list_radii(&mut self) {
        self.radii.clear();
        self.radii.extend(self.bodies.iter().map(|body| body.radius));
    }

    /// Without a contact model bodies notice no walls: a run in which they leave the box has no meaning. Collective: the same on all ranks.
    fn refuse_outside(&self, state: &State<D>) -> Result<()> {
        let outside = |place: usize, axis: usize| {
            !self.domain.periodic(axis) && !(0.0..=self.domain.size[axis]).contains(&state.bodies[place].center[axis])
        };
        let mut places = (0..state.bodies.len()).flat_map(|place| (0..D).map(move |axis| (place, axis)));
        let found = places.find(|&(place, axis)| outside(place, axis)).map(|(place, axis)| (state.number(place) * D + axis) as f64);
        let first = self.peers().min(found.unwrap_or(f64::INFINITY));
        if first.is_infinite() {
            return Ok(());
        }
        let (number, name, time) = (first as usize / D, ["x", "y", "z"][first as usize % D], state.time);
        Err(Error::Diverged(format!(
            "at time {time} body {number} has left the box along {name}; set contact.model = \"inelastic\" or an earlier time.end"
        )))
    }

    /// Over how long forces act on velocities in a step.
    fn push(&self, last_step: f64, step: f64) -> f64 {
        match self.step_control.time.scheme {
            Scheme::Euler => step,
            _ => 0.5 * (last_step + step),
        }
    }

    fn masses(&self) -> Vec<f64> {
        self.bodies.iter().map(|body| body.mass).collect()
    }

    /// How long before its time the velocities of a state live.
    fn lag(&self, state: &State<D>) -> f64 {
        match self.step_control.time.scheme {
            Scheme::Euler => 0.0,
            _ => 0.5 * state.last_step,
        }
    }

    /// The own bodies, those within reach of interactions, and those of contacts that stick.
    fn neighbours(&self, peers: Peers, state: &State<D>, adhesive_contacts: &[AdhesiveContact<D>]) -> Neighbours<D> {
        Neighbours::new(peers, &self.domain, &self.regions, state, &self.bodies, adhesive_contacts, self.reach)
    }

    /// The motions of own bodies over a step by all forces but those that a projection finds; those that are given.
    fn without_contacts(&self, state: &State<D>, step: GranularStep) -> Vec<Twist<D>> {
        let pushed = |(body, acceleration): (&Moving<D>, &Acceleration<D>)| acceleration.after(&body.twist, step.push);
        let mut moves: Vec<Twist<D>> = state.bodies.iter().zip(&self.known.accelerations).map(pushed).collect();
        let given = self.trajectories.mean_twists(state.time, step.length);
        given.for_each(|(body, twist)| state.place(body).into_iter().for_each(|place| moves[place] = twist));
        moves
    }
}

fn velocities<const D: usize>(moves: &[Twist<D>]) -> Vec<SVector<f64, D>> {
    moves.iter().map(|twist| twist.velocity).collect()
}

impl<const D: usize> Stepper<D> for Granular<D> {
    fn view(&self) -> StepperView<'_, D> {
        let twists_now = Some(&self.known.twists[..]).filter(|twists| twists.len() == self.bodies.len());
        StepperView { radii: &self.radii, interactions: &self.interactions, twists_now, flow: None }
    }

    fn free(&self) -> Vec<bool> {
        self.bodies.iter().map(|body| body.mass.is_finite()).collect()
    }

    fn gives_way(&self, state: &State<D>) -> Vec<bool> {
        self.moved_by_contacts(state)
    }

    fn settle(&mut self, state: &mut State<D>, domain: &Domain<D>) {
        state.place_given(self.given_places(state.time, state.wall).into_iter());
        if let Some(wall) = state.wall {
            self.domain.size[wall.axis] = wall.position;
        }
        let peers = Peers::from(self.session.world());
        migration::migrate(peers, domain, &self.regions, state, &mut self.bodies);
        self.known.twists.clear();
        self.list_radii();
    }

    fn heed(&mut self, stop: StopRequest) {
        self.stop = stop;
    }

    fn evaluate(&mut self, state: &State<D>, longest: f64, _: ResidualMonitor) -> Result<Observation<D>> {
        self.known = self.known(state);
        self.known.twists = self.carried_on(state);
        let twists = self.known.twists.clone();
        let motions = self.motions(state);
        let farthest = |place: usize| self.step_control.time.travel * self.radii[place];
        let stable = self.trajectories.longest_step(state.time, |body| state.place(body).map_or(f64::INFINITY, farthest));
        let limits = StepLimits { stable, accurate: f64::INFINITY, tried: longest };
        let step_size = self.step_control.next(self.peers(), &motions, StepStart { time: state.time, last_step: state.last_step }, limits);
        let kinetic_energy = Some(self.kinetic_energy(&twists));
        Ok(Observation { kinetic_energy, ..Observation::of_motions(twists, step_size) })
    }

    fn advance(&mut self, state: &State<D>, _: &Observation<D>, step: f64, _: ResidualMonitor) -> Result<StepOutcome<D>> {
        let start = Instant::now();
        let length = GranularStep { length: step, push: self.push(state.last_step, step) };
        let mut moves = self.without_contacts(state, length);
        if let Some(wall) = &self.wall {
            return self.advance_under_load(state, wall, &moves, length);
        }
        let rubs = self.interactions.friction().is_some();
        if rubs && !self.interactions.tie() {
            return self.advance_with_friction(state, &moves, length);
        }
        let rubbing = rubs.then(|| self.rub(state, &moves, length));
        let rubbed = rubbing.as_ref().map(|rubbing| &rubbing.changes[..]);
        moves.iter_mut().zip(rubbed.unwrap_or_default()).for_each(|(twist, change)| twist.spin += change.spin);
        self.advance_with_ties(state, moves, rubbing, length, start)
    }
}
