//! Linear algebra and numerical analysis that several modules need and no dependency has: direct solvers for matrices of a special shape,
//! products of slices and sparse rows, quadrature, interpolation, fits. It knows numbers only.

mod banded;
mod fit;
mod gauss;
mod interpolation;
mod product;
mod skyline;
mod sparse;
mod tridiagonal;
mod vectorized;

pub use banded::{BandedLanes, Lanes};
pub use fit::{line, proportion, proportions};
pub use gauss::gauss_legendre;
pub use interpolation::{cubic, lagrange, lagrange_slope};
pub use product::{add_rows, dot, dots, norm, padded};
pub use skyline::Skyline;
pub use sparse::SparseRows;
pub use tridiagonal::Tridiagonal;
pub use vectorized::vectorized;

/// A part of a length, a time or a number that counts as rounding: what text, sums of steps and changes of units leave.
pub const ROUNDING: f64 = 1e-9;

/// Part of the largest of a few numbers that rounding leaves where they cancel.
pub const CANCELLATION: f64 = 1e-13;
