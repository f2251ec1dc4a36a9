//! The machinery of a run: it solves what a [`Setup`] describes.

mod closure;
mod coupled;
mod instant;
mod plan;
mod setup;
mod solution;
mod suspension;

pub use coupled::Stages;
pub use instant::{Cost, Simulation};
pub use plan::Plan;
pub use setup::{Setup, SuspendedBody};
pub use solution::{BodyState, Solution};
