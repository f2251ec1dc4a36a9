//! Direct solution of banded systems, factored once.

use std::ops::{Mul, SubAssign};

/// Triangular factors of a banded matrix, with rows interchanged so that pivots are the largest.
///
/// `BELOW` entries stand below the diagonal; `UPPER` is one more than the entries above it plus `BELOW`, as interchanges fill them in.
pub struct Banded<const BELOW: usize, const UPPER: usize> {
    /// How far below the diagonal the pivot of each column was found.
    pivots: Vec<u8>,
    /// Multipliers below the diagonal, by column.
    lower: Vec<[f64; BELOW]>,
    /// Rows from the diagonal on, with the reciprocal of the pivot in the first place.
    upper: Vec<[f64; UPPER]>,
}

impl<const BELOW: usize, const UPPER: usize> Banded<BELOW, UPPER> {
    /// Room that unknowns need beyond their number.
    pub const PADDING: usize = UPPER;

    /// Factors the regular matrix of `size` rows with the given entries, for rows and columns no further apart than the band.
    pub fn new(size: usize, entry: impl Fn(usize, usize) -> f64) -> Banded<BELOW, UPPER> {
        let row =
            |row: usize, first: usize| std::array::from_fn(|place| if first + place < size { entry(row, first + place) } else { 0.0 });
        // the rows that elimination has reached, from the column at hand on
        let mut window: Vec<[f64; UPPER]> = Vec::with_capacity(BELOW + 1);
        let mut factors = Banded { pivots: Vec::with_capacity(size), lower: Vec::with_capacity(size), upper: Vec::with_capacity(size) };
        for column in 0..size {
            let last = (column + BELOW).min(size - 1);
            (column + window.len()..=last).for_each(|next| window.push(row(next, column)));
            let pivot = (0..window.len()).max_by(|&a, &b| window[a][0].abs().total_cmp(&window[b][0].abs())).unwrap_or(0);
            window.swap(0, pivot);
            let mut upper = window.remove(0);
            upper[0] = 1.0 / upper[0];
            let mut lower = [0.0; BELOW];
            for (multiplier, row) in lower.iter_mut().zip(&mut window) {
                *multiplier = row[0] * upper[0];
                *row = std::array::from_fn(|place| if place + 1 < UPPER { row[place + 1] - *multiplier * upper[place + 1] } else { 0.0 });
            }
            factors.pivots.push(pivot as u8);
            factors.lower.push(lower);
            factors.upper.push(upper);
        }
        factors
    }

    /// Replaces the right-hand side by the solution; beyond it there must be [`PADDING`](Self::PADDING) zeros, which stay.
    pub fn solve<T: Copy + SubAssign + Mul<f64, Output = T>>(&self, values: &mut [T]) {
        for (column, (lower, &pivot)) in self.lower.iter().zip(&self.pivots).enumerate() {
            let values = &mut values[column..=column + BELOW];
            values.swap(0, pivot as usize);
            for place in 0..BELOW {
                let change = values[0] * lower[place];
                values[place + 1] -= change;
            }
        }
        for (row, upper) in self.upper.iter().enumerate().rev() {
            let values = &mut values[row..row + UPPER];
            let mut value = values[0];
            for place in (1..UPPER).rev() {
                value -= values[place] * upper[place];
            }
            values[0] = value * upper[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries without pattern and with many small pivots.
    fn entry(row: usize, column: usize) -> f64 {
        let size = if row == column { 1e-9 } else { 1.0 };
        if row.abs_diff(column) <= 3 { size * ((7 * row + 13 * column) as f64).sin() } else { 0.0 }
    }

    #[test]
    fn a_banded_system_with_small_pivots_is_solved() {
        for size in [1, 2, 3, 4, 5, 8, 40] {
            let entry = |row: usize, column: usize| if size == 1 { 2.0 } else { entry(row, column) };
            let factors = Banded::<3, 7>::new(size, entry);
            let solution: Vec<f64> = (0..size).map(|row| (row as f64).cos()).collect();
            let product = |row: usize| (0..size).map(|column| entry(row, column) * solution[column]).sum::<f64>();
            let mut values: Vec<f64> = (0..size).map(product).collect();
            values.resize(size + Banded::<3, 7>::PADDING, 0.0);
            factors.solve(&mut values);
            let error = values.iter().zip(&solution).fold(0.0, |error: f64, (value, exact)| error.max((value - exact).abs()));
            assert!(error < 1e-11, "{size} rows: {error:e}");
            assert!(values[size..].iter().all(|&value| value == 0.0));
        }
    }
}
