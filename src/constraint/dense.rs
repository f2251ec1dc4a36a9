//! Dense blocks of E.

use nalgebra::DMatrix;

use super::kept_values::{KeptValues, Precision};

/// A dense block of E as it is made.
pub struct LocalBlock {
    /// The body whose columns it has.
    pub body: usize,
    /// The block, transposed.
    pub transposed: DMatrix<f64>,
    /// If it gives values at points of the surface that are still to be projected on the modes: their numbers there.
    pub at_points: Option<Vec<u32>>,
}

/// The same as it is kept.
pub struct KeptBlock {
    /// The body whose columns it has.
    pub body: usize,
    /// Their number.
    pub columns: usize,
    /// Rows of the block.
    values: KeptValues,
    at_points: Option<Vec<u32>>,
}

impl KeptBlock {
    /// The block, so exactly.
    pub fn new(LocalBlock { body, transposed, at_points }: LocalBlock, precision: Precision) -> KeptBlock {
        let values = KeptValues::new(transposed.as_slice(), precision, &mut Vec::new());
        KeptBlock { body, columns: transposed.nrows(), values, at_points }
    }

    /// Adds the product of the block with multipliers to `on_modes`, or to values `at_points` that are not projected yet; those that are not given
    /// are left alone.
    pub fn add(&self, c: &[f64], on_modes: Option<&mut [f64]>, at_points: Option<&mut [f64]>) {
        match (&self.at_points, on_modes, at_points) {
            (None, Some(out), _) => self.values.add_products(c, out),
            (Some(points), _, Some(out)) => {
                let mut products = vec![0.0; points.len()];
                self.values.add_products(c, &mut products);
                points.iter().zip(products).for_each(|(&point, product)| out[point as usize] += product);
            }
            _ => {}
        }
    }
}
