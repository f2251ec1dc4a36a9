//! Rows of C of one body: dense in its multipliers.

use super::{
    kept_values::KeptValues,
    places::{EntriesMut, Places},
};
use crate::{
    linalg::dot,
    petsc::{PetscIndex, index},
};

/// Rows, each with the unknown of the fluid to which it belongs.
#[derive(Default)]
pub struct Rows<V = Vec<f64>> {
    /// Indices in fluid vectors.
    unknowns: Vec<PetscIndex>,
    /// Once planned, their places.
    pub places: Vec<u32>,
    /// Values, multipliers running fastest.
    pub values: V,
}

/// Rows as they are kept.
pub type KeptRows = Rows<KeptValues>;

/// Values of rows that follow each other.
pub trait RowValues {
    /// Adds the product of each row with `c`.
    fn add_products(&self, c: &[f64], products: &mut [f64]);
}

impl RowValues for Vec<f64> {
    fn add_products(&self, c: &[f64], products: &mut [f64]) {
        products.iter_mut().zip(self.chunks_exact(c.len())).for_each(|(product, values)| *product += dot(values, c));
    }
}

impl RowValues for KeptValues {
    fn add_products(&self, c: &[f64], products: &mut [f64]) {
        KeptValues::add_products(self, c, products);
    }
}

impl<V: RowValues> Rows<V> {
    /// Rows of the given unknowns.
    pub fn new(unknowns: Vec<usize>, values: V) -> Rows<V> {
        Rows { unknowns: unknowns.into_iter().map(index).collect(), places: Vec::new(), values }
    }

    /// Indices in fluid vectors.
    pub fn unknowns(&self) -> impl Iterator<Item = usize> {
        self.unknowns.iter().map(|&unknown| unknown as usize)
    }

    /// The same rows with other values, and those that they had.
    pub fn with_values<W>(self, values: W) -> (Rows<W>, V) {
        (Rows { unknowns: self.unknowns, places: self.places, values }, self.values)
    }

    /// Finds the places of the unknowns.
    pub fn plan(&mut self, places: &mut Places) {
        self.places = self.unknowns().map(|unknown| places.of(unknown, 1)).collect();
    }

    /// Adds `factor * C c` to the rows of this rank and of others, with the multipliers `c` of the body; `scratch` may hold anything.
    pub fn add(&self, factor: f64, c: &[f64], scratch: &mut Vec<f64>, rows: &mut EntriesMut) {
        // products first: the scattered places then wait for memory all at once
        scratch.clear();
        scratch.resize(self.unknowns.len(), 0.0);
        self.values.add_products(c, scratch);
        for (place, product) in self.places.iter().zip(scratch) {
            *rows.at(*place) += factor * *product;
        }
    }
}
