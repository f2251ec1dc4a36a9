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

pub use banded::{BandedLanes, Lanes};
pub use fit::{line, proportion, proportions};
pub use gauss::gauss_legendre;
pub use interpolation::{cubic, lagrange, lagrange_slope};
pub use product::{add_rows, dot, dots, norm, padded};
pub use skyline::Skyline;
pub use sparse::SparseRows;
pub use tridiagonal::Tridiagonal;
