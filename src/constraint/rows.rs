//! Rows of C of one body: dense in its multipliers.

use super::places::{EntriesMut, Places};
use crate::linalg::{dot, dots};

/// Rows that are multiplied together.
const TOGETHER: usize = 4;

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

/// Rows in single precision, which take most of the memory of a crowd; products are summed in double precision.
///
/// What a value loses is added to the next row of the same multiplier and field, so that sums over rows, the momentum that a multiplier passes to the fluid,
/// are kept to the rounding of a single value.
#[derive(Default)]
pub struct SingleRows {
    /// Indices in fluid vectors.
    pub unknowns: Vec<usize>,
    /// Once planned, their places.
    pub places: Vec<u32>,
    /// Values, multipliers running fastest.
    pub values: Vec<f32>,
}

impl SingleRows {
    /// Rows of so many multipliers each, those of a field up to where it ends; `memory` is used again.
    pub fn new(Rows { unknowns, values, .. }: &Rows, count: usize, field_ends: &[usize], mut memory: Vec<f32>) -> SingleRows {
        memory.clear();
        memory.reserve_exact(values.len());
        let mut lost = vec![0.0; count];
        for (number, row) in values.chunks_exact(count).enumerate() {
            if field_ends.contains(&number) {
                // other units
                lost.fill(0.0);
            }
            memory.extend(row.iter().zip(&mut lost).map(|(value, lost)| {
                let wanted = value + *lost;
                let single = wanted as f32;
                *lost = wanted - f64::from(single);
                single
            }));
        }
        SingleRows { unknowns: unknowns.clone(), places: Vec::new(), values: memory }
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
        rest.iter_mut().zip(last_values.chunks_exact(c.len())).for_each(|(product, values)| [*product] = dots(values, c));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_rows_outlive_single_precision() {
        let (count, rows) = (7, 1000);
        let values: Vec<f64> = (0..count * rows).map(|place| (place as f64).sin().exp() - 1.2).collect();
        let double = Rows::new((0..rows).collect(), values);
        let single = SingleRows::new(&double, count, &[rows], Vec::new());
        for multiplier in 0..count {
            let sum = |values: &mut dyn Iterator<Item = f64>| values.skip(multiplier).step_by(count).sum::<f64>();
            let (kept, wanted) = (sum(&mut single.values.iter().map(|&value| f64::from(value))), sum(&mut double.values.iter().copied()));
            assert!((kept - wanted).abs() < 1e-7, "{kept} {wanted}");
        }
        let c: Vec<f64> = (0..count).map(|place| 1.0 / (1.0 + place as f64)).collect();
        let mut products = Vec::new();
        single.multiply(&c, &mut products);
        for (product, row) in products.iter().zip(double.values.chunks(count)) {
            assert!((product - crate::linalg::dot(row, &c)).abs() < 1e-6);
        }
    }
}
