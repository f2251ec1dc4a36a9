//! Quasi-static motion: bodies carried by Stokes flow, whose velocities follow from their places, contact forces included.
//!
//! Contacts act in the flow: the contact model says who touches and presses, from velocities in unbounded fluid; the
//! coupled system finds the forces that keep just these from approaching; both are repeated until they agree
//! ([`QuasiStatic::agree`]). If they should go round in circles, one contact after the other is changed, the first one that is
//! wrong (the least-index rule of Murty 1974, which ends for any positive definite mobility). Then bodies travel by the
//! two-step rule `v + dt/(2 dt_last) (v - v_last)`, the midpoint rule or Euler's, and what the rule adds to `v` is
//! projected once more, so that nothing overlaps whatever the step. The contact forces press on in this projection: else
//! bodies that landed in the last step would bounce, as the rule looks back at the velocity with which they came.
//!
//! Contacts that stick may pull as much as takes their memory back: those that are held are unknowns as above, with forces of any
//! sign; those that let go in the step pull with a known force, and act as the forces of a repulsion do.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    active_set_iteration::ActiveSetIteration,
    clusters::ClusterMotions,
    contact_step::{ContactStep, identities},
    implicit_springs::{LEAST, StepAhead, kept_apart, pair},
    kept_measures::keep,
    step_control::{StepControl, StepLimits, StepSize},
    stepper::{Effort, Observation, StepOutcome, Stepper, StepperView},
    stop_request::StopRequest,
    travel::{accurate_step, time_of_travel},
};
use crate::{
    body::{Row, Twist},
    contact::{AdhesiveContact, ContactForce, FrictionReport, KktReport, Partner, Projection},
    error::{Error, Result},
    geometry::{Ball, Domain, near_pairs, near_walls},
    interaction::{Arrangement, Forces, Interactions, PairForce, Spring, Touch, Wrench},
    mechanics::{
        Configuration, ContactHistory, FlowSolver, History, Moving, ResidualMonitor, Solution, State,
        unsteady::{COURANT, LARGEST_COURANT, starts_at_once},
    },
    parallel::Peers,
    petsc::Session,
    scene::{ConstraintMethod, Scheme, Step},
};

/// Rounds that flow and contacts are given to agree.
pub(super) const MOST_ROUNDS: usize = 60;

/// Difference between the velocities by the flow and by the contact model, over the largest ([`fastest`]), that counts as agreement,
/// unless the flow is solved to less. Films at roughness resist a million times more than bodies alone, and let velocities be known less well.
const AGREEMENT: f64 = 1e-5;
const AGREEMENT_IN_FILMS: f64 = 1e-4;

/// Part of the tolerance of a solve at an instant down to which the flow is solved where nothing else is left to agree on.
const TIGHTEST: f64 = 1e-3;

/// Tolerance of solves at most where the rate of a shear is found from what they miss by.
const LOOSEST_AT_STRESS: f64 = 1e-5;

/// How many times what it may move relative to its neighbours a body moves in the box in a first step, of whose error nothing is known.
const FIRST: f64 = 3.0;

/// Overlap, in radii, up to which clusters are kept apart in a step; the next one does the rest.
const APART: f64 = 1e-8;

/// Gap, in radii, up to which a contact of the last step is tried first.
const MEMORY_REACH: f64 = 0.1;

/// Overlap, in radii, at which a run in which bodies do not notice contact ends.
const OVERLAP: f64 = 1e-6;

/// What to do where bodies on a fitted mesh overlap, which knows of no contact.
const FITTED_REMEDY: &str =
    "no mesh fits between bodies that touch: set a shorter time.step, or method.constraint = \"sharp\" with contact.model = \"inelastic\"";

/// Bodies carried by Stokes flow.
pub struct QuasiStatic<const D: usize> {
    pub(super) session: Session,
    pub(super) suspension: Box<dyn FlowSolver<D>>,
    pub(super) step_control: StepControl,
    pub(super) radii: Vec<f64>,
    /// Force that gives each body a unit velocity in unbounded fluid.
    pub(super) weights: Vec<f64>,
    /// The same for the mean force of contacts over a step.
    contact_weights: Vec<f64>,
    pub(super) stop: StopRequest,
    /// The rate of a shear that a stress decides, as it is tried.
    pub(super) tried_rate: Option<f64>,
}

/// Velocities on which flow and contacts agree.
pub(super) struct Agreed<const D: usize> {
    pub(super) solution: Solution<D>,
    pub(super) twists: Vec<Twist<D>>,
    pub(super) contacts: Vec<ContactForce<D>>,
    pub(super) friction: Option<FrictionReport>,
    pub(super) step_size: StepSize,
}

/// Bodies of a state in the box of its time.
pub(super) struct Placed<'a, const D: usize> {
    pub(super) state: &'a State<D>,
    pub(super) domain: Domain<D>,
    pub(super) balls: Vec<Ball<D>>,
    /// The balls that touch where they do: larger by their roughness.
    pub(super) touching: Vec<Ball<D>>,
}

/// What is known of an instant before its flow is.
pub(super) struct KnownInstant<'a, const D: usize> {
    pub(super) placed: Placed<'a, D>,
    centers: Vec<SVector<f64, D>>,
    pub(super) interactions: Interactions<D>,
    /// Forces that follow from where bodies are.
    pub(super) forces: Forces<D>,
    pub(super) springs: Vec<Spring<D>>,
    /// Longest step that is to be tried; nothing in the middle of a step.
    pub(super) tried: Option<f64>,
}

impl<const D: usize> KnownInstant<'_, D> {
    /// Forces and torques on bodies that follow from where they are.
    pub(super) fn pushes(&self) -> Vec<Wrench<D>> {
        self.forces.on_bodies(self.centers.len(), &[])
    }
}

/// Rows of contacts for a solve, and what acts besides.
pub(super) struct FlowRows<'a, const D: usize> {
    pub(super) rows: &'a [Row<D>],
    pub(super) guess: &'a [f64],
    pub(super) pushes: &'a [Wrench<D>],
    /// The step in which springs move.
    pub(super) step: f64,
    pub(super) tolerance: f64,
}

impl<const D: usize> QuasiStatic<D> {
    /// Bodies of a suspension that move with a step control.
    pub fn new(session: &Session, suspension: Box<dyn FlowSolver<D>>, step_control: StepControl) -> QuasiStatic<D> {
        let weights = suspension.resistance().of_bodies();
        let radii = suspension.setup().bodies.iter().map(|suspended| suspended.body.ball.radius).collect();
        let (session, stop, contact_weights) = (session.clone(), StopRequest::default(), weights.clone());
        QuasiStatic { session, suspension, step_control, radii, weights, contact_weights, stop, tried_rate: None }
    }

    /// Whether the fluid has inertia: a solve is then a step from the one before.
    pub(super) fn evolves(&self) -> bool {
        self.suspension.evolution().is_some()
    }

    fn placed<'a>(&self, state: &'a State<D>) -> Placed<'a, D> {
        let domain = self.domain_at(state);
        let (balls, friction) = (state.balls(&self.radii), self.suspension.setup().interactions.friction());
        let touching = friction.map_or_else(|| balls.clone(), |friction| friction.touching(&balls));
        Placed { state, domain, balls, touching }
    }

    fn arrangement<'a>(&'a self, placed: &'a Placed<'a, D>) -> Arrangement<'a, D> {
        self.arrangement_of(placed, &placed.balls)
    }

    /// That of balls in the place of bodies.
    pub(super) fn arrangement_of<'a>(&'a self, placed: &'a Placed<'a, D>, balls: &'a [Ball<D>]) -> Arrangement<'a, D> {
        let (viscosity, time) = (Some(self.suspension.setup().viscosity), placed.state.time);
        Arrangement { domain: &placed.domain, numbers: None, balls, weights: &self.weights, viscosity, reach: f64::INFINITY, time }
    }

    /// Contacts over a step from where bodies are.
    pub(super) fn contact_step<'a>(&'a self, placed: &'a Placed<'a, D>, step: f64) -> ContactStep<'a, D> {
        self.contact_step_of(placed, &placed.touching, step)
    }

    /// The same of balls in the place of bodies.
    fn contact_step_of<'a>(&'a self, placed: &'a Placed<'a, D>, balls: &'a [Ball<D>], step: f64) -> ContactStep<'a, D> {
        let (arrangement, flow) = (self.arrangement_of(placed, balls), self.suspension.as_ref());
        let bounds = flow.setup().interactions.lower_bounds(&arrangement, &placed.state.stuck, step);
        let arrangement = Arrangement { weights: &self.contact_weights, ..arrangement };
        ContactStep { session: &self.session, flow, arrangement, bounds, step }
    }

    /// Velocities of bodies as their neighbours see them: where images slide, without what all take part in, but with what that does to neighbours.
    fn deviatoric_velocities(&self, state: &State<D>, twists: &[Twist<D>]) -> Vec<SVector<f64, D>> {
        let domain = &self.suspension.setup().domain;
        let strain = domain.shear_rate().abs();
        let deviatoric = |((body, twist), radius): ((&Moving<D>, &Twist<D>), &f64)| {
            let own = twist.velocity - domain.carried(&body.center);
            if strain > 0.0 { SVector::from_fn(|axis, _| if axis == 0 { own.norm() + strain * radius } else { 0.0 }) } else { own }
        };
        state.bodies.iter().zip(twists).zip(&self.radii).map(deviatoric).collect()
    }

    /// The time in which the first body moves by its radius; with inertia in the fluid, whose levels stay where they are, relative to what goes along with
    /// images alone.
    pub(super) fn time_of_travel(&self, placed: &Placed<D>, twists: &[Twist<D>]) -> f64 {
        if !self.evolves() {
            return time_of_travel(&placed.domain, &placed.balls, &velocities(twists));
        }
        self.time_in_box(placed.state, twists)
    }

    /// The same in the box, relative to what goes along with images alone.
    fn time_in_box(&self, state: &State<D>, twists: &[Twist<D>]) -> f64 {
        let deviatoric = self.deviatoric_velocities(state, twists);
        deviatoric.iter().zip(&self.radii).map(|(velocity, radius)| radius / velocity.norm()).fold(f64::INFINITY, f64::min)
    }

    /// The longest step in which free bodies err by what they may, by how far the last one led from the trapezoidal rule.
    fn accurate_step(&self, placed: &Placed<D>, twists: &[Twist<D>]) -> f64 {
        let state = placed.state;
        if state.carried.is_empty() || self.last_step(state) == 0.0 {
            return f64::INFINITY;
        }
        let followed = placed.domain.error_of_rates(state.last_step);
        let bodies = self.suspension.setup().bodies.iter().zip(&self.radii);
        let ways = state.bodies.iter().zip(twists).zip(&state.carried);
        let error = |((last, now), carried): ((&Moving<D>, &Twist<D>), &SVector<f64, D>)| {
            let mut velocity = (last.twist.velocity + now.velocity) * 0.5 - carried;
            // what goes along with images does so exactly
            velocity[0] -= followed * last.center[1];
            velocity * state.last_step
        };
        let free = bodies.zip(ways).filter(|((suspended, _), _)| suspended.body.free());
        let errors: Vec<(SVector<f64, D>, f64)> = free.map(|((_, &radius), way)| (error(way), radius)).collect();
        accurate_step(&errors, state.last_step, self.step_control.time.error)
    }

    /// The step to take with these motions and forces.
    pub(super) fn step_size(&self, placed: &Placed<D>, twists: &[Twist<D>], pushes: &[Wrench<D>], tried: Option<f64>) -> Result<StepSize> {
        let (state, travel) = (placed.state, self.step_control.time.travel);
        let first = if self.last_step(state) == 0.0 { FIRST * self.time_in_box(state, twists) } else { f64::INFINITY };
        let moved = (travel * self.time_of_travel(placed, twists).min(first)).min(self.accurate_step(placed, twists));
        let given = self.suspension.setup().trajectories.longest_step(state.time, |body| travel * self.radii[body]);
        let stable = self.suspension.evolution().map_or(Ok(f64::INFINITY), |evolution| evolution.longest_step(pushes))?;
        let stable = stable.min(given).min(moved);
        // a fixed step that is half taken was not split
        let whole = tried.is_none() && self.step_control.time.step != Step::Auto;
        let last_step = if whole && self.step_control.protocol.is_none() { 0.0 } else { self.last_step(state) };
        let limits = StepLimits { stable, tried: tried.unwrap_or(f64::INFINITY) };
        Ok(self.step_control.next::<D>(Peers::Alone, &[], (state.time, last_step), limits))
    }

    /// Solves the flow with all forces that interactions know and with contacts that keep gaps open over the step to come, no longer than `tried`; nothing for a
    /// state in the middle of a step.
    fn agree(&mut self, state: &State<D>, tried: Option<f64>, effort: &mut Effort, monitor: ResidualMonitor) -> Result<Agreed<D>> {
        match self.suspension.setup().domain.protocol().and_then(|protocol| protocol.stress()) {
            Some(stress) => self.agree_at_stress(stress, (state, tried), effort, monitor),
            None => self.agree_at_rate((state, tried), false, effort, monitor),
        }
    }

    /// The same at the rate that box and drive have; solves go on `again` from those that tried another one.
    pub(super) fn agree_at_rate(
        &mut self,
        (state, tried): (&State<D>, Option<f64>),
        again: bool,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        let instant = self.instant(state, tried, again)?;
        if instant.interactions.friction().is_some_and(|friction| friction.coefficient > 0.0) {
            return self.agree_with_friction(&instant, effort, monitor);
        }
        self.agree_without_friction(&instant, effort, monitor)
    }

    /// What is known of an instant, whose solves go on `again` from those that tried another rate.
    fn instant<'a>(&mut self, state: &'a State<D>, tried: Option<f64>, again: bool) -> Result<KnownInstant<'a, D>> {
        // where a longer step led nowhere, solves go on from those that tried it
        self.suspension.prepare(state.time, again || tried.is_none_or(f64::is_finite))?;
        if self.evolves() {
            let resistance = self.suspension.resistance();
            let of_impulse = resistance.of_impulse;
            self.weights = resistance.of_bodies();
            self.contact_weights = self.weights.iter().map(|weight| weight / of_impulse).collect();
        }
        let (placed, centers) = (self.placed(state), state.centers());
        let interactions = self.suspension.setup().interactions.clone();
        self.refuse_overlap(&placed, interactions.touch())?;
        let arrangement = self.arrangement(&placed);
        let (forces, springs) = (interactions.forces(&arrangement), interactions.springs(&arrangement));
        Ok(KnownInstant { placed, centers, interactions, forces, springs, tried })
    }

    /// The tolerance of the solves of an instant.
    pub(super) fn tolerance_of(&self, instant: &KnownInstant<D>) -> f64 {
        self.solve_tolerance(instant.placed.state)
    }

    /// That of a state.
    pub(super) fn solve_tolerance(&self, state: &State<D>) -> f64 {
        let time = &self.step_control.time;
        let error = if time.step == Step::Auto && !self.evolves() { time.error } else { 0.0 };
        let tolerance = self.suspension.setup().tolerance.in_a_step(self.travelled(state), error);
        if self.tried_rate.is_some() { tolerance.min(LOOSEST_AT_STRESS) } else { tolerance }
    }

    /// What ties bodies over a step of this length.
    pub(super) fn bonds(&self, instant: &KnownInstant<D>, step: f64) -> Vec<Row<D>> {
        [self.spring_rows(&instant.placed, &instant.springs, step), instant.interactions.welds(&instant.centers)].concat()
    }

    /// Solves the flow of an instant, and gives the motions of its bodies besides.
    pub(super) fn flow_with(
        &mut self,
        instant: &KnownInstant<D>,
        held: &FlowRows<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<(Solution<D>, Vec<Twist<D>>)> {
        let KnownInstant { placed, centers, .. } = instant;
        let bonds = self.bonds(instant, held.step);
        let configuration = Configuration {
            centers,
            time: placed.state.time,
            contacts: held.rows,
            contact_guess: held.guess,
            bonds: &bonds,
            pushes: held.pushes,
            tolerance: held.tolerance,
        };
        let mut solution = self.suspension.solve_at(&configuration, monitor)?;
        solution.pair_stress = PairForce::total_stress(&instant.forces.pairs);
        effort.add_solve(&solution.cost);
        for (found, suspended) in solution.bodies.iter_mut().zip(&self.suspension.setup().bodies) {
            // the solver meets it to its tolerance
            found.twist = suspended.body.given_motion().unwrap_or(found.twist);
        }
        let twists = solution.bodies.iter().map(|body| body.twist).collect();
        Ok((solution, twists))
    }

    /// Flow and frictionless contacts in turn.
    fn agree_without_friction(&mut self, instant: &KnownInstant<D>, effort: &mut Effort, monitor: ResidualMonitor) -> Result<Agreed<D>> {
        let KnownInstant { placed, interactions, forces, springs, .. } = instant;
        let (state, touch, tightest) = (placed.state, interactions.touch(), self.suspension.setup().tolerance.at_an_instant());
        let mut tolerance = self.tolerance_of(instant);
        let agreement = if interactions.resist() { AGREEMENT_IN_FILMS } else { AGREEMENT };
        let mut pressed = self.expected(placed, touch)?;
        let (mut chosen, mut step, mut difference) = (None, state.last_step, 0.0);
        let mut rounds = ActiveSetIteration::new();
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                self.stop.heed(self.session.world(), state.time)?;
            }
            let tied = kept_apart(springs, &self.weights, step);
            pressed.retain(|pressed| pressed.contact.other().is_none_or(|other| !tied.contains(&pair(pressed.contact.body, other))));
            let loose = self.contact_step(placed, step).loose(&pressed);
            let pushes = forces.on_bodies(instant.centers.len(), &loose);
            let (rows, guess): (Vec<Row<D>>, Vec<f64>) = pressed.iter().map(|pressed| (pressed.contact.row(step), pressed.force)).unzip();
            let held = FlowRows { rows: &rows, guess: &guess, pushes: &pushes, step, tolerance };
            let (mut solution, mut twists) = self.flow_with(instant, &held, effort, monitor)?;
            let begins = step == 0.0 && !springs.is_empty();
            let step_size = match chosen {
                Some(step_size) => step_size,
                None if begins => *chosen.insert(self.step_size(placed, &twists, &Spring::pulled(springs, pushes), instant.tried)?),
                None => *chosen.insert(self.step_size(placed, &twists, &pushes, instant.tried)?),
            };
            if begins && step_size.natural > 0.0 {
                // of springs the step is a part
                step = step_size.natural;
                continue;
            }
            if touch != Some(Touch::Hard) {
                return Ok(Agreed { solution, twists, contacts: forces.contacts.clone(), friction: None, step_size });
            }
            let start = Instant::now();
            // not the length, which the end of the run cuts short: a run that ends later must find the same
            step = if step_size.natural > 0.0 { step_size.natural } else { state.last_step };
            pressed.iter_mut().zip(&solution.contact_forces).for_each(|(pressed, force)| pressed.force = *force);
            let contacts = self.contact_step(placed, step);
            let unpressed = contacts.without_contacts(velocities(&twists), pressed.iter().chain(&loose));
            let held = if rounds.holds() { self.near(&pressed) } else { Vec::new() };
            let projection = contacts.project(&unpressed, &held)?;
            effort.contact += start.elapsed().as_secs_f64();
            let scale = fastest(&twists, &unpressed);
            let apart = largest_difference(&twists, &projection.velocities);
            difference = apart / scale;
            if difference <= agreement.max(tolerance) {
                for ((twist, body), velocity) in twists.iter_mut().zip(&mut solution.bodies).zip(&projection.velocities) {
                    (twist.velocity, body.twist.velocity) = (*velocity, *velocity);
                }
                let contacts = [&forces.contacts[..], &projection.forces].concat();
                return Ok(Agreed { solution, twists, contacts, friction: None, step_size });
            }
            let projected = contacts.closed(projection);
            if identities(&projected) == identities(&pressed) {
                // what is left of the residual may be what they differ by
                tolerance = (TIGHTEST * tightest).max(0.1 * tolerance);
            }
            let with_one_changed = |tried| contacts.with_one_changed(tried, &velocities(&twists), scale, AGREEMENT * scale);
            pressed = rounds.next(apart, pressed, projected, with_one_changed);
        }
        Err(disagreement(state.time, step, &format!("velocities differ by {difference:.1e}")))
    }

    /// Keeps bodies apart that want to move so without contact forces, and gives what presses. Where clusters cannot follow as one, what they can do is
    /// kept apart again, until both hold (alternating projections).
    fn keep_apart(
        &self,
        contacts: &ContactStep<D>,
        wanted: &[SVector<f64, D>],
        state: &State<D>,
        moves: &mut [Twist<D>],
    ) -> Result<Projection<D>> {
        let mut pressed = contacts.project(wanted, &[])?;
        moves.iter_mut().zip(&pressed.velocities).for_each(|(twist, velocity)| twist.velocity = *velocity);
        let interactions = &self.suspension.setup().interactions;
        if interactions.cluster_of().is_empty() {
            return Ok(pressed);
        }
        let smallest = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let mut clusters = ClusterMotions::nearest(interactions.clusters().iter(), state, contacts.step, moves);
        clusters.carry(moves);
        for _ in 0..MOST_ROUNDS {
            let apart = contacts.project(&velocities(moves), &[])?;
            if largest_difference(moves, &apart.velocities) * contacts.step < APART * smallest {
                break;
            }
            let pushes: Vec<SVector<f64, D>> = apart.velocities.iter().zip(&*moves).map(|(apart, twist)| apart - twist.velocity).collect();
            clusters.follow(&pushes, moves);
        }
        pressed.kkt_report.smallest_gap = contacts.smallest_gap_after(moves);
        Ok(pressed)
    }

    /// Keeps rods, areas and volumes of chains over a step, and bodies apart, in turn where bodies touch; gives the smallest gap then, if contacts are kept and
    /// bodies are near each other, which chains that press against each other may leave a little below zero.
    fn keep_chains(&self, placed: &Placed<D>, moves: &mut [Twist<D>], step: f64) -> Result<Option<f64>> {
        let interactions = &self.suspension.setup().interactions;
        if interactions.chains().is_empty() {
            return Ok(None);
        }
        let (centers, smallest) = (placed.state.centers(), self.radii.iter().copied().fold(f64::INFINITY, f64::min));
        let missed = keep(interactions, &centers, moves, step);
        missed.map_or(Ok(()), |missed| missed.check(placed.state.time, step))?;
        if interactions.touch() != Some(Touch::Hard) {
            return Ok(None);
        }
        // contacts that pull have done so
        let contacts = ContactStep { bounds: Vec::new(), ..self.contact_step(placed, step) };
        // what nothing was done to is as far apart as it was
        let rounds = if missed.is_some() { MOST_ROUNDS } else { 0 };
        for _ in 0..rounds {
            let apart = contacts.project(&velocities(moves), &[])?.velocities;
            if largest_difference(moves, &apart) * step < APART * smallest {
                break;
            }
            moves.iter_mut().zip(apart).for_each(|(twist, velocity)| twist.velocity = velocity);
            keep(interactions, &centers, moves, step);
        }
        // of surfaces, not of where they touch
        let gap = self.contact_step_of(placed, &placed.balls, step).smallest_gap_after(moves);
        Ok(Some(gap).filter(|gap| gap.is_finite()))
    }

    /// The rows of springs in a step of this length from a state, 0 if it is not known yet.
    fn spring_rows(&self, placed: &Placed<D>, springs: &[Spring<D>], length: f64) -> Vec<Row<D>> {
        if springs.is_empty() {
            return Vec::new();
        }
        let state = placed.state;
        let velocities: Vec<SVector<f64, D>> = state.bodies.iter().map(|body| body.twist.velocity).collect();
        let mut balls = placed.balls.clone();
        balls.iter_mut().zip(&velocities).for_each(|(ball, velocity)| ball.center += velocity * length);
        let ahead = self.suspension.setup().interactions.springs(&Arrangement { balls: &balls, ..self.arrangement(placed) });
        let room = self.step_control.time.travel * self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let step = StepAhead { length, last: state.last_step, velocities: &velocities, resistances: &self.weights, room, least: LEAST };
        step.rows(springs, &ahead).into_iter().map(Row::as_length).collect()
    }

    /// What flow and bodies passed in the last step over what they may pass in an automatic one; 0 without inertia.
    fn passed(&self, state: &State<D>, twists: &[Twist<D>]) -> Result<f64> {
        let on_grid = self.suspension.evolution_on_grid();
        let Some(cells) = on_grid.map_or(Ok(None), |flow| flow.courant(state.last_step))? else { return Ok(0.0) };
        let period = self.step_control.shift_period.as_ref().map(|period| period.shortest(state.time));
        let shortest = period.is_some_and(|period| state.last_step < period * 1.5);
        if cells > LARGEST_COURANT && (shortest || self.step_control.time.step != Step::Auto) {
            return Err(Error::Diverged(too_long(state, cells, period)));
        }
        let travelled = state.last_step / (self.step_control.time.travel * self.time_in_box(state, twists));
        Ok(travelled.max(cells / COURANT))
    }

    /// The longest way of the last step, in radii of the body that went it; of an automatic one no more than is asked for, however far all moved together.
    pub(super) fn travelled(&self, state: &State<D>) -> f64 {
        let last: Vec<Twist<D>> = state.bodies.iter().map(|body| body.twist).collect();
        let most = if self.step_control.time.step == Step::Auto { self.step_control.time.travel } else { f64::INFINITY };
        (state.last_step / self.time_in_box(state, &last)).min(most)
    }

    /// The contacts of these whose bodies are near each other before the step.
    fn near(&self, pressed: &[ContactForce<D>]) -> Vec<ContactForce<D>> {
        pressed.iter().filter(|pressed| pressed.contact.gap < MEMORY_REACH * self.radii[pressed.contact.body]).copied().collect()
    }

    /// The contacts that are tried first.
    fn expected(&self, placed: &Placed<D>, touch: Option<Touch>) -> Result<Vec<ContactForce<D>>> {
        let state = placed.state;
        if touch != Some(Touch::Hard) || state.last_step == 0.0 {
            return Ok(Vec::new());
        }
        let reach = MEMORY_REACH * self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let velocities = state.bodies.iter().map(|body| body.twist.velocity).collect();
        self.contact_step(placed, state.last_step).expected(&state.held, velocities, reach)
    }

    /// The contacts that stick after a step with these forces.
    fn remembered(&self, placed: &Placed<D>, forces: &[ContactForce<D>], step: f64) -> Vec<AdhesiveContact<D>> {
        self.suspension.setup().interactions.remember(&self.arrangement(placed), &placed.state.stuck, forces, step)
    }

    /// Where nothing keeps bodies apart, or too weakly, they may overlap, and a flow has no meaning then.
    fn refuse_overlap(&self, placed: &Placed<D>, touch: Option<Touch>) -> Result<()> {
        let (overlap, remedy) = match touch {
            Some(Touch::Hard) => return Ok(()),
            Some(Touch::Soft { overlap, remedy }) => (overlap, remedy),
            None if self.suspension.setup().constraint == ConstraintMethod::Fitted => (OVERLAP, FITTED_REMEDY),
            None => (OVERLAP, "set contact.model = \"inelastic\" or a shorter time.step"),
        };
        let Placed { state, domain, balls, .. } = placed;
        let pairs = near_pairs(domain, balls, 0.0).into_iter().map(|pair| (pair.first, Some(pair.second), pair.gap));
        let walls = near_walls(domain, balls, 0.0).into_iter().map(|pair| (pair.body, None, pair.gap));
        let Some((body, other, gap)) = pairs.chain(walls).find(|&(body, _, gap)| gap < -overlap * balls[body].radius) else {
            return Ok(());
        };
        let other = other.map_or("a wall".to_owned(), |other| format!("body {other}"));
        Err(Error::Diverged(format!("at time {} body {body} overlaps {other} by {:.1e}; {remedy}", state.time, -gap)))
    }

    /// The motions by which bodies travel before contacts are kept.
    fn rule(
        &mut self,
        state: &State<D>,
        (observation, length): (&Observation<D>, f64),
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
                let mut moves = two_step(state, observation, factor, &self.suspension.setup().interactions);
                self.follow_images(state, length, factor, &mut moves);
                Ok(moves)
            }
            _ => self.midpoint(state, (observation, length), effort, monitor),
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

    /// Motions half a step ahead.
    fn midpoint(
        &mut self,
        state: &State<D>,
        (observation, length): (&Observation<D>, f64),
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Vec<Twist<D>>> {
        let half = 0.5 * length;
        let mut ahead = state.clone();
        ahead.advance(&observation.twists, half);
        ahead.bodies.iter_mut().zip(&observation.twists).for_each(|(body, twist)| body.twist = *twist);
        ahead.held = observation.contacts.iter().map(ContactHistory::of).collect();
        ahead.stuck = self.remembered(&self.placed(state), &observation.contacts, half);
        Ok(self.agree(&ahead, None, effort, monitor)?.twists)
    }
}

impl<const D: usize> Stepper<D> for QuasiStatic<D> {
    fn view(&self) -> StepperView<'_, D> {
        let flow = self.suspension.as_ref();
        StepperView { radii: &self.radii, interactions: &flow.setup().interactions, twists_now: None, flow: Some(flow) }
    }

    fn free(&self) -> Vec<bool> {
        self.suspension.setup().bodies.iter().map(|own| own.body.free()).collect()
    }

    fn settle(&mut self, state: &mut State<D>, _domain: &Domain<D>) {
        state.place_given(self.suspension.setup().given_places(state.time).into_iter());
    }

    fn evaluate(&mut self, state: &State<D>, longest: f64, monitor: ResidualMonitor) -> Result<Observation<D>> {
        let mut effort = Effort::default();
        let Agreed { mut solution, twists, contacts, friction, step_size } = self.agree(state, Some(longest), &mut effort, monitor)?;
        let passed = self.passed(state, &twists)?;
        let domain = self.placed(state).domain;
        for (body, moving) in solution.bodies.iter_mut().zip(&state.bodies) {
            // centres of solutions are in the box: so are the motions that go with them
            body.twist.velocity -= domain.image_velocity(&moving.center);
        }
        Ok(Observation { twists, contacts, friction, solution: Some(solution), step_size, passed, kinetic_energy: None, effort })
    }

    fn advance(&mut self, state: &State<D>, observation: &Observation<D>, length: f64, monitor: ResidualMonitor) -> Result<StepOutcome<D>> {
        let mut effort = Effort::default();
        let mut moves = self.rule(state, (observation, length), &mut effort, monitor)?;
        let reach = self.step_control.time.travel * self.time_of_travel(&self.placed(state), &moves);
        let step = self.step_control.shortened((state.time, self.last_step(state)), length, reach);
        let (step, shear) = self.shear_over(state, step);
        self.suspension.setup().trajectories.mean_twists(state.time, step).for_each(|(body, twist)| moves[body] = twist);
        let (mut placed, start) = (self.placed(state), Instant::now());
        placed.domain = placed.domain.sheared_to(state.time, state.shear.strain, shear.mean_rate).over(step);
        let (mut stuck, mut kkt_report) = (Vec::new(), None);
        match self.suspension.setup().interactions.touch() {
            Some(Touch::Hard) => {
                let contacts = self.contact_step(&placed, step);
                let unpressed = contacts.without_contacts(velocities(&moves), &observation.contacts);
                let projection = self.keep_apart(&contacts, &unpressed, state, &mut moves)?;
                stuck = self.remembered(&placed, &projection.forces, step);
                let smallest_gap = match self.suspension.setup().interactions.friction() {
                    Some(_) => self.contact_step_of(&placed, &placed.balls, step).smallest_gap_after(&moves),
                    None => projection.kkt_report.smallest_gap,
                };
                kkt_report = Some(KktReport { smallest_gap, friction: observation.friction, ..projection.kkt_report });
            }
            Some(Touch::Soft { .. }) => kkt_report = Some(KktReport::of_forces(&observation.contacts, &placed.balls)),
            None => {}
        }
        if self.suspension.setup().interactions.touch() != Some(Touch::Hard) {
            ClusterMotions::nearest(self.suspension.setup().interactions.clusters().iter(), state, step, &moves).carry(&mut moves);
        }
        if let Some(gap) = self.keep_chains(&placed, &mut moves, step)? {
            kkt_report.iter_mut().for_each(|report| report.smallest_gap = gap);
        }
        effort.contact += start.elapsed().as_secs_f64();
        Ok(StepOutcome {
            step,
            moves,
            twists: observation.twists.clone(),
            contacts: observation.contacts.clone(),
            stuck,
            kkt_report,
            shear: shear.found,
            effort,
        })
    }

    fn heed(&mut self, stop: StopRequest) {
        self.stop = stop;
    }

    fn restore(&mut self, history: History<D>) -> Result<()> {
        self.suspension.restore(history)
    }
}

/// `v + factor (v - v_last)`; bodies that came into contact or out of it since the last step do not look back, if contact
/// forces jump.
fn two_step<const D: usize>(state: &State<D>, observation: &Observation<D>, factor: f64, interactions: &Interactions<D>) -> Vec<Twist<D>> {
    let now: Vec<ContactHistory<D>> = observation.contacts.iter().filter(|pressed| pressed.force != 0.0).map(ContactHistory::of).collect();
    let (before, after) = (contacts_of(&state.held, state.bodies.len()), contacts_of(&now, state.bodies.len()));
    let mut jumps: Vec<bool> = before.iter().zip(&after).map(|(before, after)| interactions.projects() && before != after).collect();
    for cluster in interactions.clusters() {
        let any = jumps[cluster.bodies.clone()].contains(&true);
        jumps[cluster.bodies.clone()].fill(any);
    }
    let rule = |(body, (now, last)): (usize, (&Twist<D>, &Twist<D>))| {
        if jumps[body] {
            return *now;
        }
        Twist { velocity: now.velocity + (now.velocity - last.velocity) * factor, spin: now.spin + (now.spin - last.spin) * factor }
    };
    observation.twists.iter().zip(state.bodies.iter().map(|body| &body.twist)).enumerate().map(rule).collect()
}

/// For each body its contacts, seen from it.
fn contacts_of<const D: usize>(held: &[ContactHistory<D>], bodies: usize) -> Vec<Vec<(Partner, [i32; D])>> {
    let mut of_body = vec![Vec::new(); bodies];
    for contact in held {
        of_body[contact.body].push((contact.partner, contact.image));
        if let Partner::Body(partner) = contact.partner {
            of_body[partner].push((Partner::Body(contact.body), contact.image.map(|image| -image)));
        }
    }
    of_body.iter_mut().for_each(|contacts| contacts.sort_unstable());
    of_body
}

/// What to say where flow and contacts do not agree.
pub(super) fn disagreement(time: f64, step: f64, what: &str) -> Error {
    let text = format!(
        "at time {time} flow and contacts do not agree after {MOST_ROUNDS} rounds ({what}); a shorter time.step or a finer grid may help"
    );
    Error::StepTooLong { text, step }
}

/// What to say of a step in which the flow passed so many cells, where images slide in steps that are multiples of a period.
fn too_long<const D: usize>(state: &State<D>, cells: f64, period: Option<f64>) -> String {
    let (step, time) = (state.last_step, state.time);
    let remedy = match period {
        Some(period) if step < period * 1.5 => {
            "images of a sheared box slide by whole cells in a step, so that none is shorter: make the box longer along y, or lower flow.density".into()
        }
        Some(period) => format!("set time.step = {period:.4e}, in which images slide by one cell, or \"auto\""),
        None => {
            let shorter = step * COURANT / cells;
            let unit = 10.0_f64.powf(shorter.log10().floor() - 1.0);
            format!("set time.step = {:.1e} or \"auto\"", (shorter / unit).floor() * unit)
        }
    };
    format!(
        "at time {time} the flow passes {cells:.2} cells in time.step = {step:.4e}, and is followed up to {LARGEST_COURANT} only; {remedy}"
    )
}

pub(super) fn velocities<const D: usize>(twists: &[Twist<D>]) -> Vec<SVector<f64, D>> {
    twists.iter().map(|twist| twist.velocity).collect()
}

/// Largest velocity, with contact forces or without them: where they hold bodies at rest, only what they resist tells how
/// small a velocity is.
fn fastest<const D: usize>(twists: &[Twist<D>], unpressed: &[SVector<f64, D>]) -> f64 {
    twists.iter().map(|twist| &twist.velocity).chain(unpressed).map(|velocity| velocity.norm()).fold(f64::MIN_POSITIVE, f64::max)
}

/// Largest difference of velocities.
fn largest_difference<const D: usize>(twists: &[Twist<D>], velocities: &[SVector<f64, D>]) -> f64 {
    twists.iter().zip(velocities).map(|(twist, velocity)| (twist.velocity - velocity).norm()).fold(0.0, f64::max)
}
