//! What is read off a solution: functions of a view, which change nothing.

mod cells;
mod film;
mod picture;
mod plane;
mod probe;
mod sample;
mod scalar_picture;
mod viscosity;

pub use cells::{CellCenters, inside};
pub use film::Plane;
pub use picture::picture;
pub use probe::{scalar_probe, velocity_probe};
pub use sample::{scalars, velocities};
pub use scalar_picture::scalar_picture;
pub use viscosity::{Viscosity, viscosity};
