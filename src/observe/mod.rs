//! What is read off a solution: functions of a view, which change nothing.

mod cells;
mod film;
mod picture;
mod probe;
mod sample;
mod viscosity;

pub use cells::{CellCenters, inside};
pub use film::Plane;
pub use picture::picture;
pub use probe::{scalar_probe, velocity_probe};
pub use sample::velocities;
pub use viscosity::{Viscosity, viscosity};
