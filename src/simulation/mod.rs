//! The machinery of a run: it solves what a [`Setup`] describes.

mod closure;
mod coupled;
mod instant;
mod setup;
mod solution;

pub use coupled::Stages;
pub use instant::{Cost, Simulation};
pub use setup::{Setup, SuspendedBody};
pub use solution::{BodyState, Solution};
