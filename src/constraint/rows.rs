//! Rows of C of one body: dense in its multipliers.

use super::places::{EntriesMut, Places};
use crate::linalg::{dot, dots};

/// Rows that are multiplied together.
const TOGETHER: usize = 4;

/// Rows, each with the unknown of the fluid to which it belongs.
#[derive(Default)]
pub struct Rows {
    /// Indices in fluid vectors.
    pub unknowns: Vec<usize>,
    /// Once planned, their places.
    pub places: Vec<u32>,
    /// Values, multipliers running fastest.
    pub values: Vec<f64>,
}

impl Rows {
    /// Rows of the given unknowns.
    pub fn new(unknowns: Vec<usize>, values: Vec<f64>) -> Rows {
        Rows { unknowns, places: Vec::new(), values }
    }

    /// Finds the places of the unknowns.
    pub fn plan(&mut self, places: &mut Places) {
        self.places = places.each(&self.unknowns);
    }

    /// Adds `factor * C c` to the rows of this rank and of others, with the multipliers `c` of the body; `scratch` may hold anything.
    pub fn add(&self, factor: f64, c: &[f64], scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        // products first: the scattered places then wait for memory all at once
        self.multiply(c, scratch);
        for (place, product) in self.places.iter().zip(scratch) {
            *rows.at(*place) += factor * *product;
        }
    }

    /// `products = C c`, row by row.
    fn multiply(&self, c: &[f64], products: &mut Vec<f64>) {
        products.resize(self.unknowns.len(), 0.0);
        let (parts, rest) = products.as_chunks_mut::<TOGETHER>();
        let (values, last_values) = self.values.split_at(parts.len() * TOGETHER * c.len());
        parts.iter_mut().zip(values.chunks_exact(TOGETHER * c.len())).for_each(|(products, values)| *products = dots(values, c));
        rest.iter_mut().zip(last_values.chunks_exact(c.len())).for_each(|(product, values)| *product = dot(values, c));
    }
}
