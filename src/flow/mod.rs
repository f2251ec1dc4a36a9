//! The fluid without bodies: operators, convection, drives, and the approximate inverse that preconditions everything.
//!
//! All quantities are per unit viscosity: velocities as they are, pressures and forces divided by `mu`. The Stokes
//! equations are linear in `mu`, so units cannot matter.

mod convection;
mod drive;
mod open_ends;
mod stokes;
mod stokes_inverse;
mod stokes_matrices;

pub use convection::{Convection, fastest};
pub use drive::Drive;
pub use open_ends::OpenEnds;
pub use stokes::Stokes;
pub use stokes_inverse::{FluidSystem, InverseMethod, IteratedInverse, StokesInverse, TransformInverse, Transposes};
