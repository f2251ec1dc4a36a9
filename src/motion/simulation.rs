//! The time loop: bodies move step by step, driven by a fluid or by inertia alone.

use std::{borrow::Cow, ops::Range};

use super::{
    contact_step::smallest_gap,
    given_motions::GivenStep,
    granular::{self, GranularSetup, migration::own_part},
    longest_step::{longest_step_in_flow, longest_step_of_protocol},
    quasi_static::{self, velocities},
    shift_period::ShiftPeriod,
    step_control::{StepControl, StepStart},
    stepper::{Effort, Observation, StepOutcome, Stepper, StepperView},
    stop_request::StopRequest,
};
use crate::{
    body::{Halo, Twist},
    contact::{AdhesiveContact, KktReport},
    error::{Error, Result},
    geometry::{Ball, Domain},
    interaction::Interactions,
    linalg::ROUNDING,
    mechanics::{EvolutionOnGrid, FlowSolver, History, unsteady::LARGEST_COURANT},
    petsc::Session,
    scene::{Step, TimeSection},
    setup::{ContactHistory, FoundShear, Moving, Share, State, SuspendedBody},
    system::ResidualMonitor,
};

/// Shortest step, as a part of the whole run: after so many steps that one more changes no time.
const SHORTEST: f64 = 1e-14;

/// How often a step that leads nowhere is halved before the run gives up.
const MOST_HALVINGS: usize = 6;

/// A simulation in time. Every function is collective.
pub struct Simulation<const D: usize> {
    session: Session,
    state: State<D>,
    stepper: Box<dyn Stepper<D>>,
    domain: Domain<D>,
    step_control: StepControl,
    /// Whether the end of the run cut a step short, the last one or one before: it may have turned out shorter still for it, and what follows is not what it would be.
    cut_short: bool,
    /// How often the step from the state was halved so far.
    halvings: usize,
    /// What happens in the state, if the step that led there was judged by it.
    ahead: Option<Observation<D>>,
}

/// Shorter steps that are tried in place of one.
const TRIES: usize = 8;

/// What a flow passed, over what it may, in a step whose solve ended because of it.
const MUCH: f64 = 4.0;

/// How a step went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReport {
    /// Its length.
    pub length: f64,
    /// How well contacts were kept, if there are any to keep.
    pub kkt_report: Option<KktReport>,
    /// What it cost.
    pub effort: Effort,
    /// How often it was halved because a longer one led nowhere.
    pub halvings: usize,
}

impl<const D: usize> Simulation<D> {
    /// Granular bodies in motion.
    pub fn granular(session: &Session, setup: GranularSetup<D>, time: TimeSection) -> Simulation<D> {
        let step_control = StepControl { time, shift_period: None, protocol: None, longest: setup.longest_step(), by_twos: false };
        let domain = setup.domain.clone();
        let (stepper, state) = granular::stepper(session, setup, step_control.clone());
        Simulation::driven(session, stepper, state, domain, step_control)
    }

    /// Bodies carried by Stokes flow. Where images slide, the step, if it is fixed, and the end slide them by whole cells.
    pub fn flowing(session: &Session, suspension: Box<dyn FlowSolver<D>>, time: TimeSection) -> Simulation<D> {
        let setup = suspension.setup();
        let bodies = &setup.bodies;
        let shift_period = ShiftPeriod::of(&setup.domain, suspension.grid());
        let longest = longest_step_in_flow(setup).min(longest_step_of_protocol(setup));
        let step_control =
            StepControl { time, shift_period, protocol: setup.protocol(), longest, by_twos: suspension.evolution().is_some() };
        let at_rest = |suspended: &SuspendedBody<D>| (suspended.body.ball.center, Twist::zero());
        let state = State::start(bodies.iter().map(at_rest));
        let domain = suspension.setup().domain.clone();
        let stepper = quasi_static::stepper(session, suspension, step_control.clone());
        Simulation::driven(session, stepper, state, domain, step_control)
    }

    /// Bodies in a state that anything drives.
    pub fn driven(session: &Session, stepper: Box<dyn Stepper<D>>, state: State<D>, domain: Domain<D>, step_control: StepControl) -> Self {
        Simulation { session: session.clone(), state, stepper, domain, step_control, cut_short: false, halvings: 0, ahead: None }
    }

    /// Where the bodies of this rank are.
    pub fn state(&self) -> &State<D> {
        &self.state
    }

    /// Where all bodies are, on every rank; for few bodies, and for what is done once.
    pub fn whole_state(&self) -> Cow<'_, State<D>> {
        let (state, world) = (&self.state, self.session.world());
        if state.share == Share::Whole {
            return Cow::Borrowed(state);
        }
        Cow::Owned(State {
            share: Share::Whole,
            bodies: self.gathered(&state.bodies, 0..state.count()).into_iter().map(|(body, _)| body).collect(),
            contact_history: state.whole_contact_history(world),
            adhesive_contacts: state.whole_adhesive_contacts(world).into_iter().map(AdhesiveContact::from).collect(),
            carried: Vec::new(),
            ..*state
        })
    }

    /// Goes on from another state of all bodies, with what earlier solves have left.
    ///
    /// # Errors
    /// PETSc fails.
    ///
    /// # Panics
    /// If it is the state of a share.
    pub fn restore(&mut self, state: State<D>, history: History<D>) -> Result<()> {
        (self.state, self.ahead, self.cut_short) = (own_part(&self.state.share, state), None, false);
        self.slide();
        self.stepper.settle(&mut self.state, &self.domain);
        self.stepper.restore(history)
    }

    /// The session in which it runs.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The suspension that is solved, if there is a fluid.
    pub fn suspension(&self) -> Option<&dyn FlowSolver<D>> {
        self.stepper.view().flow
    }

    /// The last solution of a flow with inertia on a grid, if there is one.
    fn evolution_on_grid(&self) -> Option<&dyn EvolutionOnGrid<D>> {
        self.suspension()?.evolution_on_grid()
    }

    /// The box as it is now.
    pub fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    /// Radii of the bodies of this rank.
    pub fn radii(&self) -> &[f64] {
        self.stepper.view().radii
    }

    /// Whether forces decide the motion of each body of this rank.
    pub fn free(&self) -> Vec<bool> {
        self.stepper.free()
    }

    /// What bodies do to each other.
    pub fn interactions(&self) -> &Interactions<D> {
        self.stepper.view().interactions
    }

    /// All bodies as balls, on every rank; as [`whole_state`](Self::whole_state).
    pub fn whole_balls(&self) -> Vec<Ball<D>> {
        let ball = |(body, radius): (Moving<D>, f64)| Ball { center: body.center, radius };
        self.whole_part(0..self.state.count()).into_iter().map(ball).collect()
    }

    /// In a flow, the smallest gap between bodies near each other now, or of one to a wall, in radii of the smaller one; infinite if none are near.
    pub fn smallest_gap(&self) -> Option<f64> {
        let StepperView { radii, interactions, flow, .. } = self.stepper.view();
        flow?;
        let weights: Vec<f64> = self.free().into_iter().map(|free| if free { 1.0 } else { f64::INFINITY }).collect();
        Some(smallest_gap(&self.domain, &self.state.balls(radii), &weights, interactions.cluster_of()))
    }

    /// The bodies of this rank with their motions at the time of the state, once it was evaluated.
    pub fn moving(&self) -> Vec<Moving<D>> {
        let mut bodies = self.state.bodies.clone();
        let now = self.stepper.view().twists_now.unwrap_or_default();
        bodies.iter_mut().zip(now).for_each(|(body, twist)| body.twist = *twist);
        bodies
    }

    /// The bodies with these numbers and their radii, on every rank, with their motions at the time of the state, once it was evaluated.
    pub fn whole_part(&self, numbers: Range<usize>) -> Vec<(Moving<D>, f64)> {
        self.gathered(&self.moving(), numbers)
    }

    /// Of bodies of this rank and of the others those with these numbers.
    fn gathered(&self, moving: &[Moving<D>], numbers: Range<usize>) -> Vec<(Moving<D>, f64)> {
        let own = moving.iter().zip(self.radii()).enumerate().map(|(place, (body, radius))| (self.state.number(place), body, radius));
        let part = own.filter(|(number, ..)| numbers.contains(number));
        if self.state.share == Share::Whole {
            return part.map(|(_, body, &radius)| (*body, radius)).collect();
        }
        let rows: Vec<f64> = part.flat_map(|(number, body, &radius)| [&[number as f64, radius], &body.pack()[..]].concat()).collect();
        let all = self.session.world().gather(&rows);
        let mut found: Vec<&[f64]> = all.chunks(2 + Moving::<D>::LENGTH).collect();
        found.sort_unstable_by(|one, two| one[0].total_cmp(&two[0]));
        found.into_iter().map(|row| (Moving::unpack(&row[2..]), row[1])).collect()
    }

    /// The bodies of this rank and those of these numbers, as balls by their places in a halo.
    pub fn halo_of(&self, required: impl Iterator<Item = usize>) -> (Halo, Vec<Ball<D>>) {
        let peers = self.state.peers(self.session.world());
        let halo = Halo::of_numbers(peers, &self.state.numbers(), required);
        let balls = halo.spread_balls(peers, &self.state.balls(self.radii()));
        (halo, balls)
    }

    /// Whether the run has reached its end.
    pub fn over(&self) -> bool {
        self.step_control.over(self.state.time)
    }

    /// That the run ends before a time that the scene asks for, where it does, and how to meet it: images slide by whole cells only.
    pub fn missed_end(&self, asked: f64) -> Option<String> {
        let (period, flow, end) = (self.step_control.shift_period.as_ref()?, self.suspension()?, self.step_control.time.end);
        if end >= asked * (1.0 - ROUNDING) {
            return None;
        }
        let multiple = if flow.evolution().is_some() { 1.0 } else { ShiftPeriod::multiple(self.step_control.time.scheme, 0.0) };
        let (cells, size) = (flow.grid().cells()[0], self.domain.size[0]);
        let remedy = period.cells_that_fit(cells, asked, multiple).map_or_else(
            || "choose an end that is a whole number of these".to_owned(),
            |fitting| format!("resolution.spacing = {{ exactly = {:?} }} meets it", size / fitting as f64),
        );
        let time = period.within(0.0, 0.0, multiple);
        Some(format!(
            "time.end = {asked}: the run ends at {end}, the last time before it at which the images of the sheared box lie on whole cells after a \
             step, which takes them {time:.6e}; {remedy}"
        ))
    }

    /// Whether the next step may reach the end.
    pub fn may_end(&self) -> bool {
        self.step_control.may_end(self.state.time, self.state.last_step)
    }

    /// Whether the state lies on the way of a longer run: no step to it was cut short by the end.
    pub fn on_the_way(&self) -> bool {
        !self.cut_short
    }

    /// From now on long work heeds a request to stop.
    pub fn heed(&mut self, stop: StopRequest) {
        self.stepper.heed(stop);
    }

    /// What happens now; to be called once for each state. Where the step ahead leads nowhere, shorter ones are tried.
    ///
    /// # Errors
    /// A solver does not converge, the shortest step is too long, or somebody asks for a stop.
    pub fn evaluate(&mut self, monitor: ResidualMonitor) -> Result<Observation<D>> {
        match self.ahead.take() {
            Some(observation) => Ok(observation),
            None => self.look(monitor).map_err(final_error),
        }
    }

    /// Moves the bodies by a step, or by a shorter one if that leads nowhere. An automatic step in a flow with inertia is followed by a look ahead: if the
    /// flow or a body passed more than it may, a shorter step is taken in its place.
    ///
    /// # Errors
    /// A solver does not converge, contacts cannot be kept, bodies of given motion meet, a body leaves the box, or somebody asks for a stop. The
    /// state is then what it was, or, where the look ahead fails or is stopped, that after the step.
    pub fn step(&mut self, observation: &Observation<D>, monitor: ResidualMonitor) -> Result<StepReport> {
        let flow = self.evolution_on_grid().filter(|_| self.step_control.time.step == Step::Auto);
        if flow.is_none_or(|flow| flow.levels().is_empty()) {
            return self.step_by(observation, observation.step_size.length, monitor);
        }
        self.step_and_look(observation, monitor)
    }

    /// What happens now, by the shortest step ahead that is tried.
    fn look(&mut self, monitor: ResidualMonitor) -> Result<Observation<D>> {
        self.halvings = 0;
        let mut longest = f64::INFINITY;
        loop {
            match self.stepper.evaluate(&self.state, longest, monitor) {
                Err(error) => longest = self.half_of(error, longest)?,
                evaluated => {
                    self.follow_rate();
                    return evaluated;
                }
            }
        }
    }

    /// A step, and what happens after it: if the flow or a body passed more than it may, a shorter one in its place.
    fn step_and_look(&mut self, observation: &Observation<D>, monitor: ResidualMonitor) -> Result<StepReport> {
        let (start, halvings) = (self.state.clone(), self.halvings);
        let (mut length, mut wasted) = (observation.step_size.length, Effort::default());
        for tries_left in (0..TRIES).rev() {
            self.halvings = halvings;
            let report = self.step_by(observation, length, monitor)?;
            let shorter = match self.look(monitor) {
                Ok(ahead) => {
                    let stands = tries_left == 0 && self.followed(report.length)?;
                    let shorter = self.step_control.in_place_of(start.time, report.length, ahead.passed).filter(|_| !stands);
                    match shorter {
                        Some(_) => wasted = wasted + report.effort + ahead.effort,
                        None => self.ahead = Some(ahead),
                    }
                    shorter
                }
                Err(error @ (Error::CourantExceeded(_) | Error::StepTooLong { .. })) => Some(
                    self.step_control
                        .in_place_of(start.time, report.length, MUCH)
                        .filter(|_| tries_left > 0)
                        .ok_or_else(|| final_error(error))?,
                ),
                Err(error) => return Err(error),
            };
            let Some(shorter) = shorter else { return Ok(StepReport { effort: wasted + report.effort, ..report }) };
            (self.state, length) = (start.clone(), shorter);
            self.slide();
        }
        Err(Error::Diverged(format!(
            "at time {} the flow passes more than {LARGEST_COURANT} cells in a step however short it is: what bonds or contacts move at once must start nearer to rest",
            start.time
        )))
    }

    /// Whether the flow can be followed that came of a step of this length.
    fn followed(&self, length: f64) -> Result<bool> {
        let cells = self.evolution_on_grid().map_or(Ok(None), |flow| flow.courant(length))?;
        Ok(cells.is_none_or(|cells| cells <= LARGEST_COURANT))
    }

    /// Moves the bodies by a step of this length, or by a shorter one if that leads nowhere.
    fn step_by(&mut self, observation: &Observation<D>, length: f64, monitor: ResidualMonitor) -> Result<StepReport> {
        let mut travel = self.travel(observation, length, monitor)?;
        self.expect_progress(travel.step)?;
        let gap = self.smallest_given_gap(&travel.moves, travel.step)?;
        if let Some(report) = &mut travel.kkt_report {
            report.smallest_gap = report.smallest_gap.min(gap);
        }
        self.state.bodies.iter_mut().zip(&travel.twists).for_each(|(body, twist)| body.twist = *twist);
        self.state.contact_history = travel.contacts.iter().filter(|active| active.force != 0.0).map(ContactHistory::of).collect();
        self.state.adhesive_contacts = travel.adhesive_contacts;
        self.state.shear = travel.shear;
        self.state.wall = travel.wall;
        self.state.carried = match self.suspension() {
            Some(flow) if flow.evolution().is_none() => velocities(&travel.moves),
            _ => Vec::new(),
        };
        self.state.advance(&travel.moves, travel.step);
        self.slide();
        // bodies of given motion by the time: sums of steps drift away
        self.stepper.settle(&mut self.state, &self.domain);
        self.cut_short |= observation.step_size.cut_short();
        Ok(StepReport { length: travel.step, kkt_report: travel.kkt_report, effort: travel.effort, halvings: self.halvings })
    }

    fn travel(&mut self, observation: &Observation<D>, mut length: f64, monitor: ResidualMonitor) -> Result<StepOutcome<D>> {
        loop {
            match self.stepper.advance(&self.state, observation, length, monitor) {
                Err(error) => {
                    // the better reason, where it is one and all ranks know of the error
                    if error.step_too_long().is_some() {
                        self.smallest_given_gap(&observation.twists, length)?;
                    }
                    length = self.half_of(error, length)?;
                }
                travelled => return travelled,
            }
        }
    }

    /// The length to try after one, or shorter than that, that ended in an error.
    fn half_of(&mut self, error: Error, tried: f64) -> Result<f64> {
        let Some(step) = error.step_too_long().map(|step| step.min(tried)) else { return Err(error.at_time(self.state.time)) };
        let start = StepStart { time: self.state.time, last_step: self.state.last_step };
        let half = self.step_control.half(start, step).filter(|_| self.halvings < MOST_HALVINGS);
        match half {
            Some(half) => {
                self.halvings += 1;
                Ok(half)
            }
            None if self.halvings == 0 => Err(error.at_time(self.state.time)),
            None => Err(error.at_time(self.state.time).saying(&format!("; steps down to {step:.3e} were tried"))),
        }
    }

    /// Smallest gap after a step of bodies of given motion that move past each other, where bodies notice that they meet. Collective.
    fn smallest_given_gap(&self, moves: &[Twist<D>], step: f64) -> Result<f64> {
        let StepperView { radii, interactions, flow, .. } = self.stepper.view();
        if interactions.touch().is_none() && flow.is_none() {
            return Ok(f64::INFINITY);
        }
        let (state, domain, free) = (&self.state, &self.domain, self.stepper.gives_way(&self.state));
        let cluster_of = interactions.cluster_of();
        GivenStep { state, domain, radii, free: &free, cluster_of, moves, step }.smallest_gap(state.peers(self.session.world()))
    }

    /// Refuses steps so short that the run never ends.
    fn expect_progress(&self, step: f64) -> Result<()> {
        let (time, end) = (self.state.time, self.step_control.time.end);
        if step >= SHORTEST * end {
            return Ok(());
        }
        let remedy = "bodies are too fast for steps that follow them: choose weaker forces, other units or a fixed time.step";
        Err(Error::Diverged(format!("at time {time} a step of {step:.3e} is too short to reach time.end = {end}; {remedy}")))
    }

    /// Lets images slide to where they are now, and a loaded wall move.
    fn slide(&mut self) {
        let (time, FoundShear { strain, rate }) = (self.state.time, self.state.shear);
        self.domain = self.domain.clone().at(time).sheared_to(time, strain, rate);
        if let Some(wall) = self.state.wall {
            self.domain.size[wall.axis] = wall.position;
        }
    }

    /// Takes the rate of a shear that a stress decides from what has found it.
    fn follow_rate(&mut self) {
        if self.domain.protocol().is_none_or(|protocol| protocol.stresses().is_none()) {
            return;
        }
        let flow = self.suspension().expect("a stress shears a fluid");
        let domain = flow.setup().domain.clone();
        (self.step_control.shift_period, self.domain) = (ShiftPeriod::of(&domain, flow.grid()), domain);
    }
}

/// The error of a step that no shorter one takes the place of.
fn final_error(error: Error) -> Error {
    match error {
        Error::CourantExceeded(text) => Error::Diverged(text),
        error => error,
    }
}
