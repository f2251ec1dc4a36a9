//! What is read off a solution: functions of a view, which change nothing.

mod picture;
mod sample;
mod viscosity;

pub use picture::picture;
pub use sample::velocities;
pub use viscosity::{Viscosity, viscosity};
