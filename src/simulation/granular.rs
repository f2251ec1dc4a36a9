//! Bodies without a fluid: inertia, gravity, and contacts (Moreau's time stepping).
//!
//! Velocities live half way between places: `v' = P(v + k f/m)`, `x' = x + dt v'`, with the projection `P` of the contact
//! model and `k` the mean of the last step and this one, which makes free flight exact under a constant force. With the
//! scheme `euler`, `k = dt`: the scheme of Maury (2006, doi:10.1007/s00211-005-0666-6) as published.

use std::time::Instant;

use nalgebra::{SMatrix, SVector};

use super::{
    Effort, GranularBody, GranularSetup, Observation, ResidualMonitor, State, StepOutcome, Stepper,
    step_control::{BodyMotion, StepControl},
};
use crate::{
    body::Twist,
    contact::{self, AdhesiveContact, ContactForce, KktReport, Problem, Projection},
    error::{Error, Result},
    geometry::Ball,
    interaction::{Arrangement, PairForce, Touch, Wrench},
    petsc::{Session, Stage, enter},
    scene::Scheme,
};

/// Granular bodies in motion.
pub struct Granular<const D: usize> {
    session: Session,
    setup: GranularSetup<D>,
    step_control: StepControl,
    masses: Vec<f64>,
    /// In the state that was looked at last.
    known: Known<D>,
}

/// Forces that follow from where bodies are.
#[derive(Default)]
struct Known<const D: usize> {
    contacts: Vec<ContactForce<D>>,
    others: Vec<PairForce<D>>,
}

/// Rates at which a motion changes.
struct Acceleration<const D: usize> {
    velocity: SVector<f64, D>,
    spin: SMatrix<f64, D, D>,
}

impl<const D: usize> Granular<D> {
    /// Granular bodies that move with a step control.
    pub fn new(session: &Session, setup: GranularSetup<D>, step_control: StepControl) -> Granular<D> {
        let masses = setup.bodies.iter().map(|body| body.mass).collect();
        Granular { session: session.clone(), setup, step_control, masses, known: Known::default() }
    }

    /// Without a contact model bodies notice no walls: a run in which they leave the box has no meaning.
    fn refuse_outside(&self, state: &State<D>) -> Result<()> {
        for (number, body) in state.bodies.iter().enumerate() {
            for axis in (0..D).filter(|&axis| !self.setup.domain.periodic(axis)) {
                if !(0.0..=self.setup.domain.size[axis]).contains(&body.center[axis]) {
                    let (name, time) = (["x", "y", "z"][axis], state.time);
                    return Err(Error::Diverged(format!(
                        "at time {time} body {number} has left the box along {name}; set contact.model = \"inelastic\" or an earlier time.end"
                    )));
                }
            }
        }
        Ok(())
    }

    /// Over how long forces act on velocities in a step.
    fn push(&self, last_step: f64, step: f64) -> f64 {
        match self.step_control.time.scheme {
            Scheme::Euler => step,
            _ => 0.5 * (last_step + step),
        }
    }

    fn arrangement<'a>(&'a self, balls: &'a [Ball<D>]) -> Arrangement<'a, D> {
        Arrangement { domain: &self.setup.domain, balls, weights: &self.masses, viscosity: None }
    }

    /// The forces that interactions know from where bodies are.
    fn known(&self, balls: &[Ball<D>]) -> Known<D> {
        let (interactions, arrangement) = (&self.setup.interactions, self.arrangement(balls));
        Known { contacts: interactions.contact_forces(&arrangement), others: interactions.pair_forces(&arrangement) }
    }

    /// Accelerations by all forces but those that a projection finds.
    fn accelerations(&self) -> Vec<Acceleration<D>> {
        let pushes = Wrench::on_bodies(self.setup.bodies.len(), &self.known.contacts, &self.known.others);
        let of = |(body, push): (&GranularBody<D>, Wrench<D>)| Acceleration {
            velocity: body.acceleration + push.force / body.mass,
            spin: body.spin_up + push.torque / body.inertia,
        };
        self.setup.bodies.iter().zip(pushes).map(of).collect()
    }

    /// Velocities that keep contacts, next to those wanted, and what contacts remember then.
    fn project(
        &self,
        state: &State<D>,
        balls: &[Ball<D>],
        moves: &[Twist<D>],
        step: f64,
    ) -> Result<(Projection<D>, Vec<AdhesiveContact<D>>)> {
        let (_stage, arrangement, interactions) = (enter(Stage::Contacts), self.arrangement(balls), &self.setup.interactions);
        let weights: Vec<f64> = self.masses.iter().map(|mass| mass / step).collect();
        let velocities: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
        let lower_bounds = interactions.lower_bounds(&arrangement, &state.stuck, step);
        let problem =
            Problem { domain: arrangement.domain, balls, weights: &weights, velocities: &velocities, step, lower_bounds: &lower_bounds };
        let projection = contact::project_from(self.session.world(), &problem, &state.memory())?;
        let stuck = interactions.remember(&arrangement, &state.stuck, &projection.forces, step);
        Ok((projection, stuck))
    }
}

impl<const D: usize> Stepper<D> for Granular<D> {
    fn evaluate(&mut self, state: &State<D>, _: ResidualMonitor) -> Result<Observation<D>> {
        let twists: Vec<Twist<D>> = state.bodies.iter().map(|body| body.twist).collect();
        self.known = self.known(&state.balls(&self.step_control.radii));
        let motions: Vec<BodyMotion<D>> = twists
            .iter()
            .zip(self.accelerations())
            // velocities live half a step before places
            .map(|(twist, acceleration)| BodyMotion {
                velocity: twist.velocity + acceleration.velocity * (0.5 * state.last_step),
                acceleration: acceleration.velocity,
            })
            .collect();
        let step_size = self.step_control.next(&motions, state.time, state.last_step);
        Ok(Observation { twists, contacts: Vec::new(), solution: None, step_size, effort: Effort::default() })
    }

    fn advance(&mut self, state: &State<D>, observation: &Observation<D>, _: ResidualMonitor) -> Result<StepOutcome<D>> {
        let (start, step) = (Instant::now(), observation.step_size.length);
        let (push, balls) = (self.push(state.last_step, step), state.balls(&self.step_control.radii));
        let pushed = |(twist, acceleration): (&Twist<D>, Acceleration<D>)| Twist {
            velocity: twist.velocity + acceleration.velocity * push,
            spin: twist.spin + acceleration.spin * push,
        };
        let mut moves: Vec<Twist<D>> = observation.twists.iter().zip(self.accelerations()).map(pushed).collect();
        let (mut contacts, mut stuck, mut kkt_report) = (self.known.contacts.clone(), Vec::new(), None);
        match self.setup.interactions.touch() {
            None => self.refuse_outside(state)?,
            Some(Touch::Soft { .. }) => kkt_report = Some(KktReport::of_forces(&contacts, &balls)),
            Some(Touch::Hard) => {
                let (projection, remembered) = self.project(state, &balls, &moves, step)?;
                moves.iter_mut().zip(&projection.velocities).for_each(|(twist, velocity)| twist.velocity = *velocity);
                stuck = remembered;
                contacts.extend(projection.forces);
                kkt_report = Some(projection.kkt_report);
            }
        }
        let effort = Effort { contact: start.elapsed().as_secs_f64(), ..Effort::default() };
        Ok(StepOutcome { step, twists: moves.clone(), moves, contacts, stuck, kkt_report, effort })
    }
}
