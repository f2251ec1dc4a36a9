//! The error bars of a run whose scene asks for an accuracy.

use serde::Serialize;

/// What was asked for, the setting that meets it, and the bars that go with it.
///
/// Bars are those of the instant at which a run starts, and of its grid and modes alone: what a step in time adds is not in them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AccuracySummary {
    /// Relative error asked for.
    pub asked: f64,
    /// Cells per radius of the smallest body that were chosen.
    pub cells_per_radius: f64,
    /// Cells per radius of all grids that were solved on to find it.
    pub calibrated_on: Vec<f64>,
    /// Seconds of these, without the last, which is the result; nothing if an earlier run had found the setting.
    pub calibration_seconds: Option<f64>,
    /// Estimated relative errors.
    pub estimated: EstimatedErrors,
    /// Drag and its bar, if there are bodies whose motion is given.
    pub drag: Option<DragSummary>,
}

/// The forces on bodies whose motion is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DragSummary {
    /// Of the forces, over these bodies.
    pub root_mean_square: f64,
    /// How far the force on such a body, or the torque over its radius, may be off, in the root mean square over them.
    pub bar: f64,
}

/// Estimated errors, relative to root mean squares over the bodies; nothing for what the scene does not answer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct EstimatedErrors {
    /// Of forces, and torques over radius, on bodies whose motion is given.
    pub drag: Option<f64>,
    /// Of velocities, and spins times radius, of free bodies.
    pub velocity: Option<f64>,
    /// Of the apparent viscosity.
    pub viscosity: Option<f64>,
    /// Of the mean velocity of a driven flow.
    pub mean_velocity: Option<f64>,
}
