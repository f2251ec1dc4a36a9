//! What moves bodies: the interface behind which a fluid, or inertia alone, drives a [`Simulation`](super::Simulation).

use super::{step_control::StepSize, stop_request::StopRequest};
use crate::{
    body::Twist,
    contact::{AdhesiveContact, ContactForce, FrictionReport, KktReport},
    error::Result,
    geometry::Domain,
    interaction::Interactions,
    mechanics::{FlowSolver, History},
    setup::{FoundShear, State, WallMotion},
    system::{Cost, ResidualMonitor, Solution},
};

/// What happens at one instant, of the bodies that the state of this rank holds.
pub struct Observation<const D: usize> {
    /// Motions of the bodies.
    pub twists: Vec<Twist<D>>,
    /// Contacts and their forces.
    pub contacts: Vec<ContactForce<D>>,
    /// How well the law of friction is kept, if it was found with the flow.
    pub friction: Option<FrictionReport>,
    /// The flow, if there is one.
    pub solution: Option<Solution<D>>,
    /// The step to take.
    pub step_size: StepSize,
    /// What flow and bodies passed in the step that led here, over what they may pass in an automatic one; 0 where that limits none.
    pub passed: f64,
    /// Kinetic energy of the bodies of this rank, where they alone have inertia; those whose motion is given have none.
    pub kinetic_energy: Option<f64>,
    /// What it took to find out.
    pub effort: Effort,
}

impl<const D: usize> Observation<D> {
    /// Bodies without a fluid that move so, whose contacts are found in the step.
    pub fn of_motions(twists: Vec<Twist<D>>, step_size: StepSize) -> Observation<D> {
        Observation {
            twists,
            contacts: Vec::new(),
            friction: None,
            solution: None,
            step_size,
            passed: 0.0,
            kinetic_energy: None,
            effort: Effort::default(),
        }
    }
}

/// What an instant or a step cost.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Effort {
    /// Solves of the flow.
    pub solves: usize,
    /// Iterations of the linear solver.
    pub iterations: usize,
    /// Seconds for jump corrections.
    pub assembly: f64,
    /// Seconds in the linear solver.
    pub solving: f64,
    /// Seconds for contacts.
    pub contact: f64,
}

/// How the bodies that the state of this rank holds move over a step.
pub struct StepOutcome<const D: usize> {
    /// Length of the step.
    pub step: f64,
    /// Motions that carry them.
    pub moves: Vec<Twist<D>>,
    /// Motions that they have after it, as far as they are known before the next instant is solved.
    pub twists: Vec<Twist<D>>,
    /// Contacts of these bodies and their forces, if they were found on the way; bodies are named by their numbers.
    pub contacts: Vec<ContactForce<D>>,
    /// Contacts that stick from now on.
    pub adhesive_contacts: Vec<AdhesiveContact<D>>,
    /// How well contacts were kept, if there are any to keep.
    pub kkt_report: Option<KktReport>,
    /// How a shear whose rate a stress decides has gone at its end.
    pub shear: FoundShear,
    /// The wall that a load presses on bodies at its end, if there is one.
    pub wall: Option<WallMotion<D>>,
    /// What it took.
    pub effort: Effort,
}

/// What a stepper knows of the bodies that the state of this rank holds.
pub struct StepperView<'a, const D: usize> {
    /// Their radii.
    pub radii: &'a [f64],
    /// What bodies do to each other.
    pub interactions: &'a Interactions<D>,
    /// Their motions at the time of the state that was evaluated last, where those of the state are of another time.
    pub twists_now: Option<&'a [Twist<D>]>,
    /// What solves the flow, if there is a fluid.
    pub flow: Option<&'a dyn FlowSolver<D>>,
}

/// What moves bodies. Every function is collective.
pub trait Stepper<const D: usize> {
    /// What happens in a state, from which no step longer than `longest` is to be tried.
    ///
    /// # Errors
    /// A solver does not converge; a [step is too long](crate::error::Error::step_too_long), and a shorter one may be tried; somebody asks for a stop.
    fn evaluate(&mut self, state: &State<D>, longest: f64, monitor: ResidualMonitor) -> Result<Observation<D>>;

    /// A step of a length, or a shorter one if it would carry bodies too far, from a state that was looked at.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate), or contacts cannot be kept.
    fn advance(&mut self, state: &State<D>, observation: &Observation<D>, length: f64, monitor: ResidualMonitor) -> Result<StepOutcome<D>>;

    /// What it knows of the bodies that the state of this rank holds.
    fn view(&self) -> StepperView<'_, D>;

    /// Whether forces decide the motion of each body that the state of this rank holds.
    fn free(&self) -> Vec<bool>;

    /// Whether a force at a contact moves each of them: those that are free, and those that are fixed to a wall that it moves.
    fn gives_way(&self, _state: &State<D>) -> Vec<bool> {
        self.free()
    }

    /// Puts bodies of given motion where they are at the time of a state, and gives bodies to the ranks that own their places in the box of that time.
    fn settle(&mut self, _state: &mut State<D>, _domain: &Domain<D>) {}

    /// From now on long work heeds a request to stop.
    fn heed(&mut self, _stop: StopRequest) {}

    /// Goes on from what earlier solves of a fluid have left, if there is one.
    ///
    /// # Errors
    /// PETSc fails.
    fn restore(&mut self, _history: History<D>) -> Result<()> {
        Ok(())
    }
}

impl Effort {
    /// Adds what a solve of the flow cost.
    pub fn add_solve(&mut self, cost: &Cost) {
        self.solves += 1;
        self.iterations += cost.krylov.iterations;
        self.assembly += cost.assembly;
        self.solving += cost.krylov.seconds;
    }
}

impl std::ops::Add for Effort {
    type Output = Effort;

    fn add(self, other: Effort) -> Effort {
        Effort {
            solves: self.solves + other.solves,
            iterations: self.iterations + other.iterations,
            assembly: self.assembly + other.assembly,
            solving: self.solving + other.solving,
            contact: self.contact + other.contact,
        }
    }
}
