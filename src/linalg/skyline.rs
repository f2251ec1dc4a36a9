//! Cholesky factors of a symmetric positive definite matrix whose rows begin where they have their first entry.

use super::product::dot;

/// The lower factor, row by row from the first entry of each to its diagonal.
pub struct Skyline {
    /// First column of each row.
    firsts: Vec<usize>,
    /// Where each row begins; one more at the end.
    starts: Vec<usize>,
    values: Vec<f64>,
}

impl Skyline {
    /// A matrix of zeros with a place for each entry from the `firsts` column of a row to the diagonal.
    pub fn new(firsts: Vec<usize>) -> Skyline {
        let mut starts = vec![0];
        firsts.iter().enumerate().for_each(|(row, first)| starts.push(starts[row] + row + 1 - first));
        let values = vec![0.0; starts[firsts.len()]];
        Skyline { firsts, starts, values }
    }

    /// Adds to an entry of the lower triangle.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let place = self.starts[row] + column - self.firsts[row];
        self.values[place] += value;
    }

    /// Turns the matrix into its factor.
    ///
    /// # Panics
    /// If the matrix is not positive definite.
    pub fn factor(mut self) -> Skyline {
        for row in 0..self.firsts.len() {
            let (above, from_here) = self.values.split_at_mut(self.starts[row]);
            let first = self.firsts[row];
            let entries = &mut from_here[..row + 1 - first];
            for column in first..row {
                let common = first.max(self.firsts[column]);
                let other = &above[self.starts[column]..self.starts[column + 1]];
                let (diagonal, left) = (other[other.len() - 1], &other[common - self.firsts[column]..column - self.firsts[column]]);
                let product = dot(&entries[common - first..column - first], left);
                entries[column - first] = (entries[column - first] - product) / diagonal;
            }
            let (diagonal, left) = entries.split_last_mut().expect("a row has its diagonal");
            *diagonal -= dot(left, left);
            assert!(*diagonal > 0.0, "the matrix is positive definite");
            *diagonal = diagonal.sqrt();
        }
        self
    }

    /// Solves in place, with the factor.
    pub fn solve(&self, x: &mut [f64]) {
        for row in 0..x.len() {
            let (left, diagonal) = self.row(row);
            x[row] = (x[row] - dot(left, &x[self.firsts[row]..row])) / diagonal;
        }
        for row in (0..x.len()).rev() {
            let (left, diagonal) = self.row(row);
            x[row] /= diagonal;
            let (above, solved) = x[self.firsts[row]..].split_at_mut(row - self.firsts[row]);
            above.iter_mut().zip(left).for_each(|(x, entry)| *x -= entry * solved[0]);
        }
    }

    fn row(&self, row: usize) -> (&[f64], f64) {
        let entries = &self.values[self.starts[row]..self.starts[row + 1]];
        (&entries[..entries.len() - 1], entries[entries.len() - 1])
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    #[test]
    fn it_solves_as_a_dense_factor_does() {
        let firsts = vec![0, 0, 1, 0, 3, 2];
        let (mut matrix, mut dense) = (Skyline::new(firsts.clone()), DMatrix::zeros(6, 6));
        for (row, &first) in firsts.iter().enumerate() {
            for column in first..=row {
                let value = if row == column { 5.0 } else { ((row * 7 + column * 3) as f64).sin() };
                matrix.add(row, column, value);
                (dense[(row, column)], dense[(column, row)]) = (value, value);
            }
        }
        let mut x: Vec<f64> = (0..6).map(|row| row as f64 - 2.5).collect();
        let wanted = dense.cholesky().unwrap().solve(&DVector::from_column_slice(&x));
        matrix.factor().solve(&mut x);
        assert!(x.iter().zip(wanted.iter()).all(|(x, wanted)| (x - wanted).abs() < 1e-14));
    }
}
