//! Dense blocks of E.

use nalgebra::DMatrix;

/// A dense block of E.
pub struct LocalBlock {
    /// The body whose columns it has.
    pub body: usize,
    /// The block, transposed.
    pub transposed: DMatrix<f64>,
}
