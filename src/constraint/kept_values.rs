//! Values of the blocks of bodies as they are kept: in single precision unless more is asked for.
//!
//! They take most of the memory of a dense suspension, and reading them most of the time of its solves. Products are summed in double precision.

use crate::linalg::{dots, vectorized};

/// Rows that are multiplied together.
const TOGETHER: usize = 4;

/// Tolerance of the solver from which on single precision is enough: it changes velocities by some 1e-9 of the fastest.
const SINGLE: f64 = 1e-7;

/// How exactly values are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 24 bits.
    Single,
    /// 48 bits: what a single value lacks is kept beside it.
    Double,
}

impl Precision {
    /// Enough for solutions to a tolerance.
    pub fn for_tolerance(tolerance: f64) -> Precision {
        if tolerance < SINGLE { Precision::Double } else { Precision::Single }
    }

    /// Bytes that a value takes.
    pub fn bytes(self) -> f64 {
        match self {
            Precision::Single => 4.0,
            Precision::Double => 8.0,
        }
    }
}

/// Rows of values that follow each other.
#[derive(Default)]
pub struct KeptValues {
    values: Vec<f32>,
    /// What these lack, or nothing.
    lost: Vec<f32>,
}

impl KeptValues {
    /// The values, so exactly; `memory` is used again.
    pub fn new(values: &[f64], precision: Precision, memory: &mut Vec<Vec<f32>>) -> KeptValues {
        let mut kept = empty(memory, values.len());
        kept.extend(values.iter().map(|&value| value as f32));
        let mut lost = Vec::new();
        if precision == Precision::Double {
            lost = empty(memory, values.len());
            lost.extend(values.iter().zip(&kept).map(|(value, kept)| (value - f64::from(*kept)) as f32));
        }
        KeptValues { values: kept, lost }
    }

    /// Values of rows of so many columns, those of a field up to where it ends; in single precision sums over the rows of a field, the momentum that a
    /// multiplier passes to the fluid, are kept to the rounding of a single value. `memory` is used again.
    pub fn of_rows(values: &[f64], columns: usize, field_ends: &[usize], precision: Precision, memory: &mut Vec<Vec<f32>>) -> KeptValues {
        match precision {
            Precision::Double => KeptValues::new(values, precision, memory),
            Precision::Single => KeptValues::with_sums(values, columns, field_ends, memory),
        }
    }

    /// Single values of rows of so many columns: what a value loses is added to that below it, up to the ends of fields, which have units of their own.
    fn with_sums(values: &[f64], columns: usize, field_ends: &[usize], memory: &mut Vec<Vec<f32>>) -> KeptValues {
        let (mut kept, mut lost) = (empty(memory, values.len()), vec![0.0; columns]);
        for (number, row) in values.chunks_exact(columns).enumerate() {
            if field_ends.contains(&number) {
                lost.fill(0.0);
            }
            kept.extend(row.iter().zip(&mut lost).map(|(value, lost)| {
                let wanted = value + *lost;
                let single = wanted as f32;
                *lost = wanted - f64::from(single);
                single
            }));
        }
        KeptValues { values: kept, lost: Vec::new() }
    }

    /// Adds the product of each row with `c`.
    pub fn add_products(&self, c: &[f64], products: &mut [f64]) {
        for values in [&self.values, &self.lost].into_iter().filter(|values| !values.is_empty()) {
            vectorized(
                #[inline(always)]
                || add_products(values, c, products),
            );
        }
    }

    /// Its memory, to be used again.
    pub fn into_memory(self) -> Vec<Vec<f32>> {
        [self.values, self.lost].into_iter().filter(|values| values.capacity() > 0).collect()
    }
}

fn empty(memory: &mut Vec<Vec<f32>>, length: usize) -> Vec<f32> {
    let mut values = memory.pop().unwrap_or_default();
    values.clear();
    values.reserve_exact(length);
    values
}

#[inline(always)]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::dot;

    #[test]
    fn sums_over_rows_outlive_single_precision_and_products_double() {
        let (count, rows) = (7, 1000);
        let values: Vec<f64> = (0..count * rows).map(|place| (place as f64).sin().exp() - 1.2).collect();
        let mut memory = Vec::new();
        let single = KeptValues::with_sums(&values, count, &[rows], &mut memory);
        for multiplier in 0..count {
            let sum = |values: &mut dyn Iterator<Item = f64>| values.skip(multiplier).step_by(count).sum::<f64>();
            let (kept, wanted) = (sum(&mut single.values.iter().map(|&value| f64::from(value))), sum(&mut values.iter().copied()));
            assert!((kept - wanted).abs() < 1e-7, "{kept} {wanted}");
        }
        let c: Vec<f64> = (0..count).map(|place| 1.0 / (1.0 + place as f64)).collect();
        for (kept, rounding) in [(single, 1e-6), (KeptValues::new(&values, Precision::Double, &mut memory), 1e-13)] {
            let mut products = vec![0.0; rows];
            kept.add_products(&c, &mut products);
            for (product, row) in products.iter().zip(values.chunks(count)) {
                assert!((product - dot(row, &c)).abs() < rounding);
            }
        }
    }
}
