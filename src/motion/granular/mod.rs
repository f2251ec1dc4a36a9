//! Bodies without a fluid: contacts and ties, projected on velocities with which nothing overlaps.

mod all_bodies;
mod chains;
mod clusters;
mod friction;
mod given;
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

use std::{borrow::Cow, ops::Range, time::Instant};

use nalgebra::SVector;

use self::{
    chains::{Accelerated, GranularStep},
    migration::Constants,
    neighbours::Neighbours,
    pressed_wall::PressedWall,
    ties::Ties,
    together::{Together, Wanting},
    velocities::{Acceleration, HalfStepBehind},
};
use super::{
    step_control::{BodyMotion, StepControl, StepLimits, StepStart},
    stepper::{Observation, StepOutcome, Stepper, StepperView},
    stop_request::StopRequest,
};
use crate::{
    body::{Halo, Regions, Trajectories, Twist},
    contact::{self, AdhesiveContact, Contact, ContactForce, KktReport, Problem, ProblemShare, ProjectionShare, bodies_of, renamed},
    dimension::same,
    error::{Error, Result},
    geometry::{Ball, Domain},
    interaction::{Arrangement, Interactions},
    parallel::Peers,
    petsc::{Session, Stage, enter},
    scene::Scheme,
    setup::{Moving, State},
    system::ResidualMonitor,
};

/// Rounds that bonds and contacts are given to agree.
const MOST_ROUNDS: usize = 2000;

/// Rounds after which bonds and contacts are solved at once to start again; after others they go on in turn.
const AT_ONCE: Range<usize> = 0..50;

/// Part of a length, an area or a volume that chains and cells may miss after a step.
const LARGEST_MISSED: f64 = 1e-6;

/// Difference between the places that bonds and contacts want after a step, in radii of the smallest body, that counts as agreement.
const AGREEMENT: f64 = 1e-7;

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

/// Velocities that keep contacts and ties.
struct Kept<const D: usize> {
    projection: ProjectionShare<D>,
    /// What contacts remember then.
    adhesive_contacts: Vec<AdhesiveContact<D>>,
    /// What contacts change the wanted velocities by that ties are next to; empty without ties.
    changes: Vec<SVector<f64, D>>,
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

    /// The motions of own bodies at the time of a state. Collective.
    fn carried_on(&self, state: &State<D>) -> Vec<Twist<D>> {
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

    /// The own bodies, those within reach of interactions, and those of contacts that stick.
    fn neighbours(&self, peers: Peers, state: &State<D>, adhesive_contacts: &[AdhesiveContact<D>]) -> Neighbours<D> {
        Neighbours::new(peers, &self.domain, &self.regions, state, &self.bodies, adhesive_contacts, self.reach)
    }

    /// The forces that interactions know from where bodies are, and accelerations by all forces but those that a projection finds.
    fn known(&self, state: &State<D>) -> Known<D> {
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

    /// The motions of own bodies over a step by all forces but those that a projection finds; those that are given.
    fn without_contacts(&self, state: &State<D>, step: GranularStep) -> Vec<Twist<D>> {
        let pushed = |(body, acceleration): (&Moving<D>, &Acceleration<D>)| acceleration.after(&body.twist, step.push);
        let mut moves: Vec<Twist<D>> = state.bodies.iter().zip(&self.known.accelerations).map(pushed).collect();
        let given = self.trajectories.mean_twists(state.time, step.length);
        given.for_each(|(body, twist)| state.place(body).into_iter().for_each(|place| moves[place] = twist));
        moves
    }

    /// Velocities that keep contacts and ties, next to those wanted.
    fn keep_apart(
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
    fn refuse_missed(&self, time: f64, step: f64, ties: &Ties<D>) -> Result<()> {
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

    /// Kinetic energy of own bodies that forces move, with these motions.
    fn kinetic_energy(&self, twists: &[Twist<D>]) -> f64 {
        let of_body = |(own, twist): (&Constants<D>, &Twist<D>)| {
            // a skew matrix has each component of the spin twice
            let turning = 0.5 * own.inertia * twist.spin.norm_squared();
            0.5 * (own.mass * twist.velocity.norm_squared() + turning)
        };
        self.bodies.iter().zip(twists).filter(|(own, _)| own.mass.is_finite()).map(of_body).sum()
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

fn velocities<const D: usize>(moves: &[Twist<D>]) -> Vec<SVector<f64, D>> {
    moves.iter().map(|twist| twist.velocity).collect()
}

impl<const D: usize> Granular<D> {
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
        let pulls = if state.last_step > 0.0 { Vec::new() } else { self.pulls_of_bonds(state) };
        let moving = state.bodies.iter().zip(&self.known.accelerations).zip(&self.radii).enumerate();
        let wall = self.wall.as_ref().zip(state.wall).map(|(pressed, wall)| pressed.motion(&wall, state.last_step));
        let motions: Vec<BodyMotion<D>> = moving
            // velocities live half a step before places
            .map(|(place, ((body, acceleration), &radius))| BodyMotion {
                radius,
                velocity: body.twist.velocity + acceleration.velocity * (0.5 * state.last_step),
                acceleration: pulls.get(place).map_or(acceleration.velocity, |pull| acceleration.velocity + pull / self.bodies[place].mass),
            })
            .chain(wall)
            .chain(self.turns(state))
            .collect();
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

fn disagreement(time: f64, step: f64, apart: f64) -> Error {
    let text = format!(
        "at time {time} contacts do not agree with bonds and rigid clusters after {MOST_ROUNDS} rounds (places differ by {apart:.1e}); a shorter \
         time.step or softer chains may help"
    );
    Error::StepTooLong { text, step }
}
