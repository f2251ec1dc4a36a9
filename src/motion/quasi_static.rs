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

use nalgebra::{SMatrix, SVector};

use super::{
    clusters::ClusterMotions,
    contact_step::ContactStep,
    implicit_springs::{LEAST, StepAhead},
    step_control::{StepControl, StepSize, StepStart},
    stepper::{Effort, Observation, StepOutcome, Stepper, StepperView},
    stop_request::StopRequest,
};
use crate::{
    body::{Row, Twist},
    contact::{AdhesiveContact, ContactForce, FrictionReport, KktReport},
    dimension::same,
    error::{Error, Result},
    geometry::{Ball, Domain},
    interaction::{Arrangement, Forces, Interactions, PairForce, Spring, Touch, Wrench},
    mechanics::{FlowSolver, History},
    petsc::Session,
    scene::Scheme,
    setup::{Configuration, State},
    system::{ResidualMonitor, Solution},
};

/// Rounds that flow and contacts are given to agree.
pub(super) const MOST_ROUNDS: usize = 60;

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
    pub(super) centers: Vec<SVector<f64, D>>,
    pub(super) rotations: Vec<SMatrix<f64, D, D>>,
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

    /// Whether the first step of the run is due, and springs move in it.
    pub(super) fn begins_on_springs(&self) -> bool {
        self.placed.state.last_step == 0.0 && !self.springs.is_empty()
    }

    /// The step for which contacts and springs are looked at: not the one that the end of the run cuts short, as a run that ends later must find the same, but
    /// in a first one on springs, of which that is a part and from whose start such a run goes on.
    pub(super) fn expected_step(&self, step_size: StepSize) -> f64 {
        if self.begins_on_springs() { step_size.length } else { step_size.natural }
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

/// What moves bodies of a suspension with a step control.
pub(super) fn stepper<const D: usize>(
    session: &Session,
    suspension: Box<dyn FlowSolver<D>>,
    step_control: StepControl,
) -> Box<dyn Stepper<D>> {
    match D {
        2 => same(in_plane(session, same(suspension), step_control)),
        _ => same(in_space(session, same(suspension), step_control)),
    }
}

fn in_plane(session: &Session, suspension: Box<dyn FlowSolver<2>>, step_control: StepControl) -> Box<dyn Stepper<2>> {
    Box::new(QuasiStatic::new(session, suspension, step_control))
}

fn in_space(session: &Session, suspension: Box<dyn FlowSolver<3>>, step_control: StepControl) -> Box<dyn Stepper<3>> {
    Box::new(QuasiStatic::new(session, suspension, step_control))
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

    pub(super) fn placed<'a>(&self, state: &'a State<D>) -> Placed<'a, D> {
        let domain = self.domain_at(state);
        let (balls, friction) = (state.balls(&self.radii), self.suspension.setup().interactions.friction());
        let touching = friction.map_or_else(|| balls.clone(), |friction| friction.touching(&balls));
        Placed { state, domain, balls, touching }
    }

    pub(super) fn arrangement<'a>(&'a self, placed: &'a Placed<'a, D>) -> Arrangement<'a, D> {
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
    pub(super) fn contact_step_of<'a>(&'a self, placed: &'a Placed<'a, D>, balls: &'a [Ball<D>], step: f64) -> ContactStep<'a, D> {
        let (arrangement, flow) = (self.arrangement_of(placed, balls), self.suspension.as_ref());
        let bounds = flow.setup().interactions.lower_bounds(&arrangement, &placed.state.adhesive_contacts, step);
        let arrangement = Arrangement { weights: &self.contact_weights, ..arrangement };
        ContactStep { session: &self.session, flow, arrangement, bounds, step }
    }

    /// Solves the flow with all forces that interactions know and with contacts that keep gaps open over the step to come, no longer than `tried`; nothing for a
    /// state in the middle of a step.
    pub(super) fn agree(
        &mut self,
        state: &State<D>,
        tried: Option<f64>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<Agreed<D>> {
        match self.suspension.setup().domain.protocol().and_then(|protocol| protocol.stress(state.time)) {
            Some(stress) => self.agree_at_stress(stress, state, tried, effort, monitor),
            None => self.agree_at_rate(state, tried, false, effort, monitor),
        }
    }

    /// The same at the rate that box and drive have; solves go on `again` from those that tried another one.
    pub(super) fn agree_at_rate(
        &mut self,
        state: &State<D>,
        tried: Option<f64>,
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
        self.suspension.prepare(state.time, &self.domain_at(state), again || tried.is_none_or(f64::is_finite))?;
        if self.evolves() {
            let resistance = self.suspension.resistance();
            let of_impulse = resistance.of_impulse;
            self.weights = resistance.of_bodies();
            self.contact_weights = self.weights.iter().map(|weight| weight / of_impulse).collect();
        }
        let (placed, centers) = (self.placed(state), state.centers());
        let rotations = state.bodies.iter().map(|body| body.rotation).collect();
        let interactions = self.suspension.setup().interactions.clone();
        self.refuse_overlap(&placed, interactions.touch())?;
        let arrangement = self.arrangement(&placed);
        let (forces, springs) = (interactions.forces(&arrangement), interactions.springs(&arrangement));
        Ok(KnownInstant { placed, centers, rotations, interactions, forces, springs, tried })
    }

    /// What ties bodies over a step of this length.
    pub(super) fn bonds(&self, instant: &KnownInstant<D>, step: f64) -> Vec<Row<D>> {
        [self.spring_rows(instant, step), instant.interactions.welds(&instant.centers)].concat()
    }

    /// Solves the flow of an instant, and gives the motions of its bodies besides.
    pub(super) fn flow_with(
        &mut self,
        instant: &KnownInstant<D>,
        flow_rows: &FlowRows<D>,
        effort: &mut Effort,
        monitor: ResidualMonitor,
    ) -> Result<(Solution<D>, Vec<Twist<D>>)> {
        let KnownInstant { placed, centers, rotations, .. } = instant;
        let bonds = self.bonds(instant, flow_rows.step);
        let configuration = Configuration {
            centers,
            rotations,
            time: placed.state.time,
            contacts: flow_rows.rows,
            contact_guess: flow_rows.guess,
            bonds: &bonds,
            pushes: flow_rows.pushes,
            tolerance: flow_rows.tolerance,
        };
        let mut solution = self.suspension.solve_at(&configuration, monitor)?;
        solution.pair_stress = PairForce::total_stress(&instant.forces.pairs);
        solution.loads.clone_from(&instant.forces.single);
        effort.add_solve(&solution.cost);
        for (found, suspended) in solution.bodies.iter_mut().zip(&self.suspension.setup().bodies) {
            // the solver meets it to its tolerance
            found.twist = suspended.body.given_motion().unwrap_or(found.twist);
        }
        let twists = solution.bodies.iter().map(|body| body.twist).collect();
        Ok((solution, twists))
    }

    /// The rows of springs in a step of this length from a state, 0 if it is not known yet.
    fn spring_rows(&self, instant: &KnownInstant<D>, length: f64) -> Vec<Row<D>> {
        let KnownInstant { placed, springs, .. } = instant;
        if springs.is_empty() {
            return Vec::new();
        }
        let (state, pushes) = (placed.state, instant.pushes());
        let velocities: Vec<SVector<f64, D>> = state.bodies.iter().map(|body| body.twist.velocity).collect();
        let mut balls = placed.balls.clone();
        balls.iter_mut().zip(&velocities).for_each(|(ball, velocity)| ball.center += velocity * length);
        let ahead = self.suspension.setup().interactions.springs(&Arrangement { balls: &balls, ..self.arrangement(placed) });
        // Euler's rule does not look back
        let last = if self.step_control.time.scheme == Scheme::Euler { 0.0 } else { state.last_step };
        let step = StepAhead { length, last, velocities: &velocities, ..self.first_step(&pushes) };
        step.rows(springs, &ahead).into_iter().map(Row::as_length).collect()
    }

    /// The first step of springs, of which nothing is known but forces.
    fn first_step<'a>(&'a self, pushes: &'a [Wrench<D>]) -> StepAhead<'a, D> {
        let room = self.step_control.time.travel * self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        StepAhead { length: 0.0, last: 0.0, velocities: &[], resistances: &self.weights, pushes, room, least: LEAST }
    }

    /// The longest first step of the run on springs: of its error nothing is known, and they may come to rest within it. Infinite for others.
    pub(super) fn first_step_on_springs(&self, instant: &KnownInstant<D>) -> f64 {
        if instant.begins_on_springs() { self.first_step(&instant.pushes()).first(&instant.springs) } else { f64::INFINITY }
    }

    /// The contacts that stick after a step with these forces.
    pub(super) fn remembered(&self, placed: &Placed<D>, forces: &[ContactForce<D>], step: f64) -> Vec<AdhesiveContact<D>> {
        self.suspension.setup().interactions.remember(&self.arrangement(placed), &placed.state.adhesive_contacts, forces, step)
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
        let mut moves = self.rule(state, observation, length, &mut effort, monitor)?;
        let reach = self.step_control.time.travel * self.time_of_travel(&self.placed(state), &moves);
        let start = StepStart { time: state.time, last_step: self.last_step(state) };
        let step = self.step_control.shortened(start, length, reach);
        let (step, shear) = self.shear_over(state, step);
        self.suspension.setup().trajectories.mean_twists(state.time, step).for_each(|(body, twist)| moves[body] = twist);
        let (mut placed, start) = (self.placed(state), Instant::now());
        placed.domain = placed.domain.sheared_to(state.time, state.shear.strain, shear.mean_rate).over(step);
        let (adhesive_contacts, mut kkt_report) = self.keep_contacts(&placed, observation, &mut moves, step)?;
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
            adhesive_contacts,
            kkt_report,
            shear: shear.found,
            wall: None,
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

impl<const D: usize> QuasiStatic<D> {
    /// Makes motions over a step keep hard contacts; what sticks then, and how well the law of contacts is kept.
    fn keep_contacts(
        &self,
        placed: &Placed<D>,
        observation: &Observation<D>,
        moves: &mut [Twist<D>],
        step: f64,
    ) -> Result<(Vec<AdhesiveContact<D>>, Option<KktReport>)> {
        match self.suspension.setup().interactions.touch() {
            Some(Touch::Hard) => {
                let contacts = self.contact_step(placed, step);
                // by the convex law contacts that slip open: what pushes them apart stays, and its steps, by Euler's rule, have nothing to make up for
                let opens = self.suspension.setup().interactions.surfaces().largest().convex;
                let pressed = if opens { &[] } else { &observation.contacts[..] };
                let unpressed = contacts.without_contacts(velocities(moves), pressed);
                let projection = self.keep_apart(&contacts, &unpressed, placed.state, moves)?;
                let adhesive_contacts = self.remembered(placed, &projection.forces, step);
                let smallest_gap = match self.suspension.setup().interactions.friction() {
                    Some(_) => self.contact_step_of(placed, &placed.balls, step).smallest_gap_after(moves),
                    None => projection.kkt_report.smallest_gap,
                };
                Ok((adhesive_contacts, Some(KktReport { smallest_gap, friction: observation.friction, ..projection.kkt_report })))
            }
            Some(Touch::Soft { .. }) => Ok((Vec::new(), Some(KktReport::of_forces(&observation.contacts, &placed.balls)))),
            None => Ok((Vec::new(), None)),
        }
    }
}

/// What to say where flow and contacts do not agree.
pub(super) fn disagreement(time: f64, step: f64, what: &str) -> Error {
    let text = format!(
        "at time {time} flow and contacts do not agree after {MOST_ROUNDS} rounds ({what}); a shorter time.step or a finer grid may help"
    );
    Error::StepTooLong { text, step }
}

pub(super) fn velocities<const D: usize>(twists: &[Twist<D>]) -> Vec<SVector<f64, D>> {
    twists.iter().map(|twist| twist.velocity).collect()
}
