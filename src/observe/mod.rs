//! What is read off a solution: functions of a view, which change nothing.

mod cells;
mod picture;
mod sample;
mod viscosity;

pub use cells::{CellCenters, inside};
pub use picture::picture;
pub use sample::velocities;
pub use viscosity::{Viscosity, shear_rate, viscosity};
