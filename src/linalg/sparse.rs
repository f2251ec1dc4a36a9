//! Sparse rows, made one by one and applied as a matrix.

/// Rows of a sparse matrix, one after the other.
#[derive(Default)]
pub struct SparseRows {
    ends: Vec<u32>,
    terms: Vec<(u32, f64)>,
}

impl SparseRows {
    /// Adds a row.
    pub fn push(&mut self, terms: impl IntoIterator<Item = (u32, f64)>) {
        self.terms.extend(terms);
        self.ends.push(self.terms.len() as u32);
    }

    /// The rows, as columns and entries.
    pub fn iter(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.terms[start as usize..end as usize])
    }

    /// The product with a vector.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        self.iter().map(|row| row.iter().map(|&(column, entry)| entry * values[column as usize]).sum()).collect()
    }

    /// The product of the transpose, of so many columns, with a vector.
    pub fn apply_transpose(&self, rows: &[f64], columns: usize) -> Vec<f64> {
        let mut values = vec![0.0; columns];
        for (row, value) in self.iter().zip(rows) {
            row.iter().for_each(|&(column, entry)| values[column as usize] += entry * value);
        }
        values
    }
}
