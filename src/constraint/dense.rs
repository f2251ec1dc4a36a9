//! Dense blocks of E.

use nalgebra::DMatrix;

use super::kept_values::{KeptValues, Precision};

/// A dense block of E as it is made.
pub struct LocalBlock {
    /// The body whose columns it has.
    pub body: usize,
    /// The block, transposed.
    pub transposed: DMatrix<f64>,
}

/// The same as it is kept.
pub struct KeptBlock {
    /// The body whose columns it has.
    pub body: usize,
    /// Their number.
    pub columns: usize,
    /// Rows of the block.
    values: KeptValues,
}

impl KeptBlock {
    /// The block, so exactly.
    pub fn new(LocalBlock { body, transposed }: &LocalBlock, precision: Precision) -> KeptBlock {
        KeptBlock { body: *body, columns: transposed.nrows(), values: KeptValues::new(transposed.as_slice(), precision, &mut Vec::new()) }
    }

    /// Adds the product of the block with multipliers.
    pub fn add(&self, c: &[f64], out: &mut [f64]) {
        self.values.add_products(c, out);
    }
}
