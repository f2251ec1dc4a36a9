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

pub mod fourier;
mod lanes;
pub mod quadrature;
mod radial;
mod scalar;
mod shape;
mod solid_harmonics;
pub mod spherical;
mod table;
#[cfg(test)]
mod tests;
mod turn;

use std::f64::consts::PI;

use nalgebra::DMatrix;

pub use fourier::Fourier;
pub use quadrature::{Quadrature, axial, quadrature};
pub use scalar::{ScalarModes, ScalarSurface};
pub use shape::Shape;
pub use spherical::Spherical;
pub use table::SurfaceTable;
pub use turn::{Family, turn};

/// Multiplier modes on the surface of a ball: tractions `F` on `gamma`, linear in real coefficients, and the jump functions they cause.
///
/// Rigid modes come first: the translations `F = e_i`, then the rotations, `F = tau` (counter-clockwise) in 2D and
/// `F = sqrt(3/2) e_k x n` in 3D. Every mode has `mean |F|^2 = 1` and is orthogonal to the others; the constant
/// pressure inside is left out. Points are `dimension` consecutive numbers.
pub trait Modes {
    /// Space dimension `D`, 2 or 3.
    fn dimension(&self) -> usize;

    /// Radius `a` of the ball.
    fn radius(&self) -> f64;

    /// Number of modes, rigid ones included.
    fn count(&self) -> usize;

    /// Writes in `out[mode * D + i]` the traction of unit coefficient at the surface point with outward unit normal `direction`.
    fn traction(&self, direction: &[f64], out: &mut [f64]);

    /// Writes in `out[point * stride + mode]` one component of the velocity jump `D_u` at each of the offsets from the centre, none zero;
    /// `stride = out.len() / points` is at least the number of modes, and what lies between is left alone.
    fn velocity_jumps(&self, offsets: &[f64], component: usize, out: &mut [f64]);

    /// Writes in `out[point * stride + mode]` the pressure jump `D_p` at each of the offsets from the centre, none zero.
    fn pressure_jumps(&self, offsets: &[f64], out: &mut [f64]);

    /// The velocity of an isolated ball in unbounded fluid tested with the modes, symmetric positive definite.
    ///
    /// Entry `(m, n)` is the mean over `gamma` of `F_m . u_n`, with `u_n` the velocity that unit coefficient `n` causes.
    /// In 2D, where a net force has no bounded velocity, the length `reach > a` cuts the logarithm:
    /// `ln(reach/a)`, at least 0.5.
    fn isolated_mobility(&self, reach: f64) -> DMatrix<f64>;

    /// Writes in `out[mode * D + i]` the velocity that unit coefficients cause in unbounded fluid at `offset`, outside the ball.
    ///
    /// Its mean over `gamma` with the tractions is [`isolated_mobility`](Self::isolated_mobility); `reach` as there.
    fn exterior_velocity(&self, offset: &[f64], reach: f64, out: &mut [f64]);

    /// Writes in `out[mode]` the pressure that goes with [`exterior_velocity`](Self::exterior_velocity).
    fn exterior_pressure(&self, offset: &[f64], out: &mut [f64]);

    /// The modes, sorted by how they turn.
    fn families(&self) -> Vec<Family>;

    /// Number of rigid modes, `D(D+1)/2`.
    fn rigid_count(&self) -> usize {
        self.dimension() * (self.dimension() + 1) / 2
    }

    /// Net force on the fluid of a unit translation coefficient: the [`area`].
    fn force_factor(&self) -> f64 {
        area(self.dimension(), self.radius())
    }

    /// Net torque on the fluid of a unit rotation coefficient: the area times the [`lever`].
    fn torque_factor(&self) -> f64 {
        self.force_factor() * lever(self.dimension(), self.radius())
    }
}

/// Area of a sphere, `4 pi a^2`, or length of a circle, `2 pi a`.
pub fn area(dimension: usize, radius: f64) -> f64 {
    match dimension {
        2 => 2.0 * PI * radius,
        _ => 4.0 * PI * radius.powi(2),
    }
}

/// Velocity of a rotation mode at unit spin: `a` on a circle, `a sqrt(2/3)` on a sphere.
pub fn lever(dimension: usize, radius: f64) -> f64 {
    match dimension {
        2 => radius,
        _ => radius * (2.0_f64 / 3.0).sqrt(),
    }
}

/// Highest order of modes that are tabulated.
pub fn highest_order(dimension: usize) -> usize {
    if dimension == 2 { fourier::MAXIMUM_ORDER } else { spherical::MAXIMUM_ORDER }
}

/// Number of modes of a family up to `order`, rigid ones included.
pub fn mode_count(dimension: usize, order: usize) -> usize {
    match dimension {
        2 => 4 * order + 1,
        _ => 3 * order * (order + 2),
    }
}

/// The modes of a ball: Fourier modes `|k| <= order` on a circle, vector spherical harmonics `l <= order` on a sphere.
///
/// # Panics
///
/// If `dimension` is not 2 or 3, or `order` is not between 1 and the `MAXIMUM_ORDER` of the family.
pub fn modes(dimension: usize, radius: f64, viscosity: f64, order: usize) -> Box<dyn Modes> {
    match dimension {
        2 => Box::new(Fourier::new(radius, viscosity, order)),
        3 => Box::new(Spherical::new(radius, viscosity, order)),
        _ => panic!("modes exist in dimension 2 and 3, not {dimension}"),
    }
}
