//! What is read off a solution: functions of a view, which change nothing.

mod body;
mod cells;
mod chains;
mod drag;
mod film;
mod inertia;
mod membranes;
mod pairs;
mod picture;
mod plane;
mod probe;
mod sample;
mod scalar_picture;
mod shear;
pub mod statistics;
mod stress;
mod viscosity;
mod vorticity;

pub use body::FrameBody;
pub use cells::{CellCenters, inside};
pub use chains::ChainNumbers;
pub use drag::{ForceCoefficients, Stream};
pub use film::{AnimatedDisk, AnimationFrame, Film, FlowCut, Plane};
pub use inertia::InertialNumbers;
pub use membranes::MembraneNumbers;
pub use pairs::{NEAR, PairCounts, PairDistribution};
pub use picture::picture;
pub use plane::{Bond, Disk, Picture};
pub use probe::{Probe, scalar_probe, velocity_probe};
pub use sample::{scalars, velocities};
pub use scalar_picture::scalar_picture;
pub use shear::Shear;
pub use stress::{NormalStresses, Stress};
pub use viscosity::{Viscosity, viscosity};
pub use vorticity::{CellVorticity, vorticity_at};
