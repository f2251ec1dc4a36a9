//! Direct solution of symmetric tridiagonal systems, such as diffusion along a line.

use std::ops::{Add, Mul};

/// Factors of the symmetric tridiagonal matrix with -1 beside the diagonal.
pub struct Tridiagonal {
    inverse_pivots: Vec<f64>,
}

impl Tridiagonal {
    /// Factors the matrix with the given diagonal, which must not be less than two anywhere and more than two somewhere.
    pub fn new(diagonal: impl Iterator<Item = f64>) -> Tridiagonal {
        let pivots = diagonal.scan(0.0, |before, entry| {
            *before = 1.0 / (entry - *before);
            Some(*before)
        });
        Tridiagonal { inverse_pivots: pivots.collect() }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.inverse_pivots.len()
    }

    /// Replaces the right-hand side by the solution.
    pub fn solve<T: Copy + Default + Add<Output = T> + Mul<f64, Output = T>>(&self, values: &mut [T]) {
        let mut before = T::default();
        for (value, &inverse) in values.iter_mut().zip(&self.inverse_pivots) {
            *value = (*value + before) * inverse;
            before = *value;
        }
        before = T::default();
        for (value, &inverse) in values.iter_mut().zip(&self.inverse_pivots).rev() {
            *value = *value + before * inverse;
            before = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tridiagonal_system_is_solved() {
        let size = 30;
        let diagonal = |row: usize| if row == 0 || row == size - 1 { 3.0 } else { 2.0 };
        let solution: Vec<f64> = (0..size).map(|row| (row as f64).cos()).collect();
        let at = |row: usize| solution.get(row).copied().unwrap_or(0.0);
        let product = |row: usize| diagonal(row) * at(row) - at(row.wrapping_sub(1)) - at(row + 1);
        let mut values: Vec<f64> = (0..size).map(product).collect();
        Tridiagonal::new((0..size).map(diagonal)).solve(&mut values);
        assert!(values.iter().zip(&solution).all(|(value, exact)| (value - exact).abs() < 1e-12));
    }
}
