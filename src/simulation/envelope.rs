//! A symmetric positive definite matrix in rows from the first entry that is not zero on, factored by Cholesky, which fills nothing outside.

/// Part of a diagonal entry below which a row depends on those before it.
const DEPENDENT: f64 = 1e-12;

/// The factor.
pub struct Envelope {
    /// First column of each row, and its entries from there up to the diagonal.
    rows: Vec<(usize, Vec<f64>)>,
}

impl Envelope {
    /// The factor of a matrix of so many rows with these entries, of which `first` tells where a row begins. Rows that depend on others are left out.
    pub fn factored(size: usize, first: impl Fn(usize) -> usize, entry: impl Fn(usize, usize) -> f64) -> Envelope {
        let mut rows: Vec<(usize, Vec<f64>)> = Vec::with_capacity(size);
        for row in 0..size {
            let start = first(row);
            let mut entries: Vec<f64> = (start..=row).map(|column| entry(row, column)).collect();
            let whole = entries[row - start];
            for column in start..row {
                let (their_start, theirs) = &rows[column];
                let common = start.max(*their_start)..column;
                let product: f64 = common.map(|place| entries[place - start] * theirs[place - their_start]).sum();
                entries[column - start] = (entries[column - start] - product) / theirs[column - their_start];
            }
            let square = whole - entries[..row - start].iter().map(|entry| entry * entry).sum::<f64>();
            entries[row - start] = if square > DEPENDENT * whole { square.sqrt() } else { f64::INFINITY };
            rows.push((start, entries));
        }
        Envelope { rows }
    }

    /// Replaces a right-hand side by the solution.
    pub fn solve(&self, values: &mut [f64]) {
        for (row, (start, entries)) in self.rows.iter().enumerate() {
            let (before, diagonal) = entries.split_at(row - start);
            let known: f64 = before.iter().zip(&values[*start..row]).map(|(entry, value)| entry * value).sum();
            values[row] = (values[row] - known) / diagonal[0];
        }
        for (row, (start, entries)) in self.rows.iter().enumerate().rev() {
            let (before, diagonal) = entries.split_at(row - start);
            values[row] /= diagonal[0];
            let value = values[row];
            values[*start..row].iter_mut().zip(before).for_each(|(other, entry)| *other -= entry * value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring: neighbours and both ends are coupled.
    #[test]
    fn a_matrix_with_a_ragged_edge_is_solved() {
        let size = 9;
        let entry = |row: usize, column: usize| match row.abs_diff(column) {
            0 => 3.0 + row as f64,
            1 => -1.0,
            8 => 0.5,
            _ => 0.0,
        };
        let factor = Envelope::factored(size, |row| if row == 8 { 0 } else { row.saturating_sub(1) }, entry);
        let wanted: Vec<f64> = (0..size).map(|row| (row as f64).sin()).collect();
        let mut values: Vec<f64> = (0..size).map(|row| (0..size).map(|column| entry(row, column) * wanted[column]).sum()).collect();
        factor.solve(&mut values);
        assert!(values.iter().zip(&wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-14), "{values:?}");
    }

    #[test]
    fn a_row_that_depends_on_another_bears_nothing() {
        let factor = Envelope::factored(2, |_| 0, |_, _| 2.0);
        let mut values = vec![3.0, 3.0];
        factor.solve(&mut values);
        assert_eq!(values, [1.5, 0.0]);
    }
}
