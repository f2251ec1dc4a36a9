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

/// Tolerance of the solver from which on single precision is enough: it changes velocities by some 1e-9 of the fastest.
const SINGLE: f64 = 1e-7;

/// How exactly rows are kept. They take most of the memory of a dense suspension.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// What a value loses is added to the next row of the same multiplier and field, so that sums over rows, the momentum that a multiplier passes to the
    /// fluid, are kept to the rounding of a single value.
    Single,
    /// What a value in single precision loses is kept beside it: 48 bits.
    Double,
}

impl Precision {
    /// Enough for solutions to a tolerance.
    pub fn for_tolerance(tolerance: f64) -> Precision {
        if tolerance < SINGLE { Precision::Double } else { Precision::Single }
    }
}

/// Rows as they are kept; products are summed in double precision.
#[derive(Default)]
pub struct KeptRows {
    /// Indices in fluid vectors.
    pub unknowns: Vec<usize>,
    /// Once planned, their places.
    pub places: Vec<u32>,
    /// Values, multipliers running fastest.
    values: Vec<f32>,
    /// What these lack, or nothing.
    lost: Vec<f32>,
}

impl KeptRows {
    /// Rows of so many multipliers each, those of a field up to where it ends; `memory` is used again.
    pub fn new(rows: &Rows, count: usize, field_ends: &[usize], precision: Precision, memory: &mut Vec<Vec<f32>>) -> KeptRows {
        let mut empty = || {
            let mut values = memory.pop().unwrap_or_default();
            values.clear();
            values.reserve_exact(rows.values.len());
            values
        };
        let mut kept = empty();
        if precision == Precision::Double {
            let mut lost = empty();
            kept.extend(rows.values.iter().map(|&value| value as f32));
            lost.extend(rows.values.iter().zip(&kept).map(|(value, single)| (value - f64::from(*single)) as f32));
            return KeptRows { unknowns: rows.unknowns.clone(), places: Vec::new(), values: kept, lost };
        }
        keep_sums(&rows.values, count, field_ends, &mut kept);
        KeptRows { unknowns: rows.unknowns.clone(), places: Vec::new(), values: kept, lost: Vec::new() }
    }

    /// Its memory, to be used again.
    pub fn into_memory(self) -> Vec<Vec<f32>> {
        vec![self.values, self.lost]
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
        add_products(&self.values, c, products);
        if !self.lost.is_empty() {
            add_products(&self.lost, c, products);
        }
    }
}

/// Single values with the sums over the rows of a field, of each multiplier, that doubles have.
fn keep_sums(values: &[f64], count: usize, field_ends: &[usize], kept: &mut Vec<f32>) {
    let mut lost = vec![0.0; count];
    for (number, row) in values.chunks_exact(count).enumerate() {
        if field_ends.contains(&number) {
            // other units
            lost.fill(0.0);
        }
        kept.extend(row.iter().zip(&mut lost).map(|(value, lost)| {
            let wanted = value + *lost;
            let single = wanted as f32;
            *lost = wanted - f64::from(single);
            single
        }));
    }
}

/// Adds the products of rows with `c`.
fn add_products(values: &[f32], c: &[f64], products: &mut [f64]) {
    let (parts, rest) = products.as_chunks_mut::<TOGETHER>();
    let (values, last_values) = values.split_at(parts.len() * TOGETHER * c.len());
    for (products, values) in parts.iter_mut().zip(values.chunks_exact(TOGETHER * c.len())) {
        products.iter_mut().zip(dots::<TOGETHER>(values, c)).for_each(|(product, more)| *product += more);
    }
    for (product, values) in rest.iter_mut().zip(last_values.chunks_exact(c.len())) {
        let [more] = dots(values, c);
        *product += more;
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
    fn sums_over_rows_outlive_single_precision_and_products_double() {
        let (count, rows) = (7, 1000);
        let values: Vec<f64> = (0..count * rows).map(|place| (place as f64).sin().exp() - 1.2).collect();
        let double = Rows::new((0..rows).collect(), values);
        let mut memory = Vec::new();
        let mut kept = |precision| KeptRows::new(&double, count, &[rows], precision, &mut memory);
        let (single, whole) = (kept(Precision::Single), kept(Precision::Double));
        for multiplier in 0..count {
            let sum = |values: &mut dyn Iterator<Item = f64>| values.skip(multiplier).step_by(count).sum::<f64>();
            let (kept, wanted) = (sum(&mut single.values.iter().map(|&value| f64::from(value))), sum(&mut double.values.iter().copied()));
            assert!((kept - wanted).abs() < 1e-7, "{kept} {wanted}");
        }
        let c: Vec<f64> = (0..count).map(|place| 1.0 / (1.0 + place as f64)).collect();
        let mut products = Vec::new();
        for (rows, rounding) in [(single, 1e-6), (whole, 1e-13)] {
            rows.multiply(&c, &mut products);
            for (product, row) in products.iter().zip(double.values.chunks(count)) {
                assert!((product - crate::linalg::dot(row, &c)).abs() < rounding);
            }
        }
    }
}
