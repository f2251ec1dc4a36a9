//! Columns of the tables that a run writes step by step.

use std::{fs, path::Path};

use crate::error::{Error, Result};

/// Names of the components of a vector.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A table with a row for each step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepColumns {
    names: Vec<String>,
    /// What is not there is not a number.
    rows: Vec<Vec<f64>>,
}

impl StepColumns {
    /// That of a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(path: &Path) -> Result<StepColumns> {
        let text = fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        Ok(StepColumns::parse(&text))
    }

    fn parse(text: &str) -> StepColumns {
        let mut lines = text.lines().map(|line| line.split(','));
        let names = lines.next().into_iter().flatten().map(str::to_owned).collect();
        let rows = lines.map(|cells| cells.map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
        StepColumns { names, rows }
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let place = self.names.iter().position(|own| own == name)?;
        Some(self.rows.iter().map(|row| row.get(place).copied().unwrap_or(f64::NAN)).collect())
    }

    /// The largest number of a column.
    pub fn largest(&self, name: &str) -> Option<f64> {
        self.column(name)?.into_iter().reduce(f64::max)
    }

    /// Lengths of a vector whose components along the axes have columns of these names.
    pub fn lengths(&self, name: impl Fn(&str) -> String) -> Option<Vec<f64>> {
        self.mean_lengths(&[name])
    }

    /// Lengths of the mean of such vectors; nothing if one of them has no columns.
    pub fn mean_lengths(&self, vectors: &[impl Fn(&str) -> String]) -> Option<Vec<f64>> {
        let axes: Vec<&str> = AXES.into_iter().filter(|axis| vectors.iter().any(|name| self.names.contains(&name(axis)))).collect();
        let mut squares = vec![0.0; self.rows.len()];
        for axis in &axes {
            let columns = vectors.iter().map(|name| self.column(&name(axis))).collect::<Option<Vec<_>>>()?;
            for (row, square) in squares.iter_mut().enumerate() {
                *square += (columns.iter().map(|column| column[row]).sum::<f64>() / columns.len() as f64).powi(2);
            }
        }
        (!axes.is_empty()).then(|| squares.into_iter().map(f64::sqrt).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_and_means_of_vectors_are_read_by_name() {
        let table = StepColumns::parse("time,force_x_0,force_y_0,force_x_2,force_y_2\n0,,,,\n1,1,2,5,6\n");
        assert_eq!(table.largest("time"), Some(1.0));
        let force = |body: usize| move |axis: &str| format!("force_{axis}_{body}");
        let means = table.mean_lengths(&[force(0), force(2)]).expect("both are there");
        assert!(means[0].is_nan() && means[1] == 5.0, "the mean is (3, 4): {means:?}");
        assert_eq!(table.lengths(force(2)).map(|lengths| lengths[1]), Some(61.0_f64.sqrt()));
        assert_eq!((table.mean_lengths(&[force(0), force(1)]), table.column("gap")), (None, None));
    }
}
