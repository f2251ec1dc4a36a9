//! The machinery of a run: it solves what a [`Setup`] describes.

mod basis;
mod bodies;
mod closure;
mod coupled;
mod memory;
mod plan;
mod setup;
mod solution;
mod suspension;
mod touching;

pub use coupled::Stages;
pub use plan::Plan;
pub use setup::{Setup, SuspendedBody};
pub use solution::{BodyState, Solution};
pub use suspension::{Cost, Moment, Suspension};
pub use touching::Touch;
