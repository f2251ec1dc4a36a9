//! Multiplier modes on the surface of a ball, the jumps they cause in closed form, and quadrature on that surface.
//!
//! A body acts on the fluid by a traction `F` spread over its surface `gamma`; across it the flow has known jumps
//! (`[q] = outside - inside`, `n` outward):
//!
//! ```text
//! [u] = 0     [p] = F.n     mu [du/dn] = -(F - (F.n) n)
//! ```
//!
//! The jump functions `D_u`, `D_p` are the Stokes solution near `gamma` that extends these jumps.
//! Modes are orthonormal in the mean over `gamma`, and the first of them are the rigid motions.
//! This module knows no grid, no box and no other body.

mod circle_pair;
pub mod fourier;
mod modes;
mod of_dimension;
pub mod quadrature;
mod radial;
mod rotation;
mod scalar;
mod shape;
mod simd;
mod solid_harmonics;
mod sphere_pair;
pub mod spherical;
mod spin_up;
mod table;
#[cfg(test)]
mod tests;
mod unsteady;

pub use fourier::Fourier;
pub use modes::{Modes, area, lever};
pub use of_dimension::{highest_order, mode_count, modes, pair_mobility, quadrature, wall_mobility};
pub use quadrature::{Quadrature, circle, sphere};
pub use rotation::{Degree, rotations};
pub use scalar::ScalarModes;
pub use shape::Shape;
pub use spherical::Spherical;
pub use spin_up::{WithSpinUp, unit_rotation};
pub use table::SurfaceTable;
