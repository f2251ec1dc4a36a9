//! The time loop: bodies move step by step, driven by a fluid or by inertia alone.

use super::{
    ContactHistory, Effort, ExtrapolationHistory, FlowSolver, Granular, GranularSetup, Observation, QuasiStatic, ResidualMonitor, State,
    Stepper, interactions,
    shift_period::ShiftPeriod,
    step_control::{ROUNDING, StepControl},
};
use crate::{
    contact::KktReport,
    error::{Error, Result},
    geometry::Domain,
    petsc::Session,
    scene::TimeSection,
};

/// Shortest step, as a part of the whole run: after so many steps that one more changes no time.
const SHORTEST: f64 = 1e-14;

/// A simulation in time. Every function is collective.
pub struct Simulation<const D: usize> {
    state: State<D>,
    stepper: Box<dyn Stepper<D>>,
    domain: Domain<D>,
    step_control: StepControl,
    /// Whether the last step was cut short by the end of the run.
    cut_short: bool,
}

/// How a step went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepReport {
    /// Its length.
    pub length: f64,
    /// How well contacts were kept, if there are any to keep.
    pub kkt_report: Option<KktReport>,
    /// What it cost.
    pub effort: Effort,
}

impl<const D: usize> Simulation<D> {
    /// Granular bodies in motion.
    pub fn granular(session: &Session, setup: GranularSetup<D>, time: TimeSection) -> Simulation<D> {
        let radii = setup.bodies.iter().map(|body| body.radius).collect();
        let step_control = StepControl { time, radii, shift_period: None, longest: setup.longest_step() };
        let (state, domain) = (setup.start(), setup.domain.clone());
        let stepper = Box::new(Granular::new(session, setup, step_control.clone()));
        Simulation { state, stepper, domain, step_control, cut_short: false }
    }

    /// Bodies carried by Stokes flow. Where images slide, the step, if it is fixed, and the end slide them by whole cells.
    pub fn flowing(session: &Session, suspension: Box<dyn FlowSolver<D>>, time: TimeSection) -> Simulation<D> {
        let setup = suspension.setup();
        let bodies = &setup.bodies;
        let shift_period = ShiftPeriod::of(&setup.domain, suspension.grid());
        let longest = interactions::longest_step_in_flow(setup);
        let step_control =
            StepControl { time, radii: bodies.iter().map(|suspended| suspended.body.ball.radius).collect(), shift_period, longest };
        let at_rest = |suspended: &super::SuspendedBody<D>| (suspended.body.ball.center, crate::body::Twist::zero());
        let state = State::start(bodies.iter().map(at_rest));
        let domain = suspension.setup().domain.clone();
        let stepper = Box::new(QuasiStatic::new(session, suspension, step_control.clone()));
        Simulation { state, stepper, domain, step_control, cut_short: false }
    }

    /// Where bodies are.
    pub fn state(&self) -> &State<D> {
        &self.state
    }

    /// Goes on from another state, with what earlier solves say about the next one.
    pub fn restore(&mut self, state: State<D>, past: Option<ExtrapolationHistory<D>>) {
        self.state = state;
        self.slide();
        if let Some(past) = past {
            self.stepper.remember(past);
        }
    }

    /// The suspension that is solved, if there is a fluid.
    pub fn suspension(&self) -> Option<&dyn FlowSolver<D>> {
        self.stepper.suspension()
    }

    /// The box as it is now.
    pub fn domain(&self) -> &Domain<D> {
        &self.domain
    }

    /// Radii of the bodies.
    pub fn radii(&self) -> &[f64] {
        &self.step_control.radii
    }

    /// Whether the run has reached its end.
    pub fn over(&self) -> bool {
        self.step_control.over(self.state.time)
    }

    /// Whether the next step may reach the end.
    pub fn may_end(&self) -> bool {
        self.step_control.may_end(self.state.time, self.state.last_step)
    }

    /// Whether the state lies on the way of a longer run: its last step was not cut short by the end.
    pub fn on_the_way(&self) -> bool {
        !self.cut_short
    }

    /// What happens now; to be called once for each state.
    ///
    /// # Errors
    /// A solver does not converge.
    pub fn evaluate(&mut self, monitor: ResidualMonitor) -> Result<Observation<D>> {
        self.stepper.evaluate(&self.state, monitor)
    }

    /// Moves the bodies by a step.
    ///
    /// # Errors
    /// A solver does not converge, contacts cannot be kept, or a body leaves the box.
    pub fn step(&mut self, observation: &Observation<D>, monitor: ResidualMonitor) -> Result<StepReport> {
        let travel = self.stepper.advance(&self.state, observation, monitor)?;
        self.expect_progress(travel.step)?;
        self.state.bodies.iter_mut().zip(&travel.twists).for_each(|(body, twist)| body.twist = *twist);
        self.state.held = travel.contacts.iter().filter(|pressed| pressed.force != 0.0).map(ContactHistory::of).collect();
        self.state.stuck = travel.stuck;
        self.state.advance(&travel.moves, travel.step);
        self.slide();
        // whole cells of images that slide may be rounded
        self.cut_short = observation.step_size.cut_short() && travel.step >= observation.step_size.length * (1.0 - ROUNDING);
        Ok(StepReport { length: travel.step, kkt_report: travel.kkt_report, effort: travel.effort })
    }

    /// Refuses steps so short that the run never ends.
    fn expect_progress(&self, step: f64) -> Result<()> {
        let (time, end) = (self.state.time, self.step_control.time.end);
        if step >= SHORTEST * end {
            return Ok(());
        }
        let remedy = "bodies are too fast for steps that follow them: choose weaker forces, other units or a fixed time.step";
        Err(Error::Diverged(format!("at time {time} a step of {step:.3e} leads nowhere before time.end = {end}; {remedy}")))
    }

    /// Lets images slide to where they are now.
    fn slide(&mut self) {
        self.domain = self.domain.clone().at(self.state.time);
    }
}
