//! What a scene is solved for, as vectors that two grids can be compared by.

use serde::{Deserialize, Serialize};

use crate::{body::components, error::Result, flow::Drive, mechanics::FlowSolver, observe, setup::Setup, system::Solution};

/// Something that a solve answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EstimatedQuantity {
    /// Forces, and torques over radius, on bodies whose motion is given; with inertia at the end of the run.
    Drag,
    /// Velocities, and spins times radius, of free bodies; with inertia the largest of the run.
    Velocity,
    /// Apparent viscosity of a sheared suspension of free bodies.
    Viscosity,
    /// Mean velocity of a flow that a pressure gradient or a body force drives.
    MeanVelocity,
}

/// The numbers of a quantity; errors are relative to their root mean square, which for one body or one number is its size.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationAnswer {
    /// What they are.
    pub quantity: EstimatedQuantity,
    /// The numbers, the same on all ranks.
    pub values: Vec<f64>,
}

impl EstimatedQuantity {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            EstimatedQuantity::Drag => "drag",
            EstimatedQuantity::Velocity => "velocity",
            EstimatedQuantity::Viscosity => "viscosity",
            EstimatedQuantity::MeanVelocity => "mean velocity",
        }
    }
}

impl CalibrationAnswer {
    /// All that a solution answers; collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn all<const D: usize>(suspension: &dyn FlowSolver<D>, solution: &Solution<D>) -> Result<Vec<CalibrationAnswer>> {
        let setup = suspension.setup();
        let viscosity = observe::viscosity(setup, suspension.grid(), solution, &[])?;
        let (drag, velocity) = of_bodies(setup, solution);
        let driven = match setup.drive {
            Drive::PressureGradient(drive) | Drive::BodyForce(drive) if drive.norm() > 0.0 => solution.mean_velocity.as_slice(),
            _ => &[],
        };
        let all = [
            (EstimatedQuantity::Drag, drag),
            (EstimatedQuantity::Velocity, velocity),
            (EstimatedQuantity::Viscosity, viscosity.iter().map(|viscosity| viscosity.relative()).collect()),
            (EstimatedQuantity::MeanVelocity, driven.to_vec()),
        ];
        Ok(all
            .into_iter()
            .filter(|(_, values)| !values.is_empty())
            .map(|(quantity, values)| CalibrationAnswer { quantity, values })
            .collect())
    }

    /// How far it is from another answer to the same, relative to itself.
    pub fn distance(&self, other: &CalibrationAnswer) -> f64 {
        let difference = norm(self.values.iter().zip(&other.values).map(|(one, two)| one - two));
        if difference == 0.0 { 0.0 } else { difference / self.norm() }
    }

    /// Root of the sum of the squares.
    pub fn norm(&self) -> f64 {
        norm(self.values.iter().copied())
    }
}

fn norm(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|number| number * number).sum::<f64>().sqrt()
}

/// What the fluid does to bodies whose motion is given, and how the free ones move.
pub fn of_bodies<const D: usize>(setup: &Setup<D>, solution: &Solution<D>) -> (Vec<f64>, Vec<f64>) {
    let (mut drag, mut velocity) = (Vec::new(), Vec::new());
    for (suspended, state) in setup.bodies.iter().zip(&solution.bodies) {
        let radius = suspended.body.ball.radius;
        if suspended.body.free() {
            velocity.extend(state.twist.velocity.iter());
            velocity.extend(components(&state.twist.spin).iter().map(|spin| spin * radius));
        } else {
            drag.extend(state.force.iter());
            drag.extend(components(&state.torque).iter().map(|torque| torque / radius));
        }
    }
    (drag, velocity)
}
