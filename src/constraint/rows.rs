//! Rows of C of one body: dense in its multipliers.

use super::{
    kept_values::{KeptValues, Precision},
    places::{EntriesMut, Places},
};
use crate::linalg::dot;

/// Rows in double precision, each with the unknown of the fluid to which it belongs.
#[derive(Default)]
pub struct Rows {
    /// Indices in fluid vectors.
    pub unknowns: Vec<usize>,
    /// Once planned, their places.
    pub places: Vec<u32>,
    /// Values, multipliers running fastest.
    pub values: Vec<f64>,
}

/// Rows as they are kept.
#[derive(Default)]
pub struct KeptRows {
    /// Indices in fluid vectors.
    pub unknowns: Vec<usize>,
    /// Once planned, their places.
    pub places: Vec<u32>,
    /// Values, multipliers running fastest.
    values: KeptValues,
}

impl KeptRows {
    /// Rows of so many multipliers each, those of a field up to where it ends; `memory` is used again.
    ///
    /// In single precision sums over the rows of a field, the momentum that a multiplier passes to the fluid, are kept to the rounding of a single value.
    pub fn new(rows: &Rows, count: usize, field_ends: &[usize], precision: Precision, memory: &mut Vec<Vec<f32>>) -> KeptRows {
        let values = match precision {
            Precision::Double => KeptValues::new(&rows.values, precision, memory),
            Precision::Single => KeptValues::with_sums(&rows.values, count, field_ends, memory),
        };
        KeptRows { unknowns: rows.unknowns.clone(), places: Vec::new(), values }
    }

    /// Its memory, to be used again.
    pub fn into_memory(self) -> Vec<Vec<f32>> {
        self.values.into_memory()
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
        products.clear();
        products.resize(self.unknowns.len(), 0.0);
        self.values.add_products(c, products);
    }
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
        products.clear();
        products.extend(self.values.chunks_exact(c.len()).map(|values| dot(values, c)));
    }
}
