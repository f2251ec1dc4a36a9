//! Tables that a run writes row by row, read again by the names of their columns: a line of names, then lines of numbers, with commas between cells.

use std::{fs, path::Path};

use crate::error::{Error, Result};

/// Names of the components of a vector.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// Numbers by columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    /// Of each column; what is not there is not a number.
    numbers: Vec<Vec<f64>>,
    rows: usize,
}

/// The names in the first line of a table.
pub fn column_names(line: &str) -> Vec<String> {
    line.split(',').map(|name| name.trim().to_owned()).collect()
}

/// The cells of a row; what is no number is not a number.
pub fn row_numbers(line: &str) -> impl Iterator<Item = f64> {
    line.split(',').map(|cell| cell.trim().parse().unwrap_or(f64::NAN))
}

impl Columns {
    /// Those of a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(path: &Path) -> Result<Columns> {
        let text = fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        Ok(Columns::parse(&text))
    }

    /// Those of a text.
    pub fn parse(text: &str) -> Columns {
        Columns::chosen(text.lines(), |_| true)
    }

    /// Those of lines whose names are wanted; the others take no memory.
    pub fn chosen(lines: impl IntoIterator<Item = impl AsRef<str>>, wanted: impl Fn(&str) -> bool) -> Columns {
        let mut lines = lines.into_iter();
        let all = lines.next().map_or(Vec::new(), |line| column_names(line.as_ref()));
        let taken: Vec<bool> = all.iter().map(|name| wanted(name)).collect();
        let names: Vec<String> = all.into_iter().zip(&taken).filter_map(|(name, taken)| taken.then_some(name)).collect();
        let mut columns = Columns { numbers: vec![Vec::new(); names.len()], names, rows: 0 };
        for line in lines {
            let cells = row_numbers(line.as_ref()).chain(std::iter::repeat(f64::NAN)).zip(&taken);
            let cells = cells.filter_map(|(cell, taken)| taken.then_some(cell));
            columns.numbers.iter_mut().zip(cells).for_each(|(column, cell)| column.push(cell));
            columns.rows += 1;
        }
        columns
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.names.iter().position(|own| own == name).map(|place| self.numbers[place].as_slice())
    }

    /// The number of a row in the column of a name; nothing where either is not there.
    pub fn number(&self, name: &str, row: usize) -> Option<f64> {
        self.column(name)?.get(row).copied().filter(|number| !number.is_nan())
    }

    /// The columns of two names side by side, in rows that have both numbers; empty if there is no such column.
    pub fn curve(&self, abscissa: &str, name: &str) -> Vec<(f64, f64)> {
        let (Some(places), Some(values)) = (self.column(abscissa), self.column(name)) else { return Vec::new() };
        places.iter().copied().zip(values.iter().copied()).filter(|(place, value)| !place.is_nan() && !value.is_nan()).collect()
    }

    /// The largest number of a column.
    pub fn largest(&self, name: &str) -> Option<f64> {
        self.column(name)?.iter().copied().reduce(f64::max)
    }

    /// Lengths of a vector whose components along the axes have columns of these names.
    pub fn lengths(&self, name: impl Fn(&str) -> String) -> Option<Vec<f64>> {
        self.mean_lengths(&[name])
    }

    /// Lengths of the mean of such vectors; nothing if one of them has no columns.
    pub fn mean_lengths(&self, vectors: &[impl Fn(&str) -> String]) -> Option<Vec<f64>> {
        let axes: Vec<&str> = AXES.into_iter().filter(|axis| vectors.iter().any(|name| self.names.contains(&name(axis)))).collect();
        let mut squares = vec![0.0; self.rows];
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
        let table = Columns::parse("time,force_x_0,force_y_0,force_x_2,force_y_2\n0,,,,\n1,1,2,5,6\n");
        assert_eq!((table.largest("time"), table.rows()), (Some(1.0), 2));
        let force = |body: usize| move |axis: &str| format!("force_{axis}_{body}");
        let means = table.mean_lengths(&[force(0), force(2)]).expect("both are there");
        assert!(means[0].is_nan() && means[1] == 5.0, "the mean is (3, 4): {means:?}");
        assert_eq!(table.lengths(force(2)).map(|lengths| lengths[1]), Some(61.0_f64.sqrt()));
        assert_eq!((table.mean_lengths(&[force(0), force(1)]), table.column("gap")), (None, None));
    }

    #[test]
    fn a_curve_leaves_out_what_is_no_number() {
        let table = Columns::parse("step,time,a\n0,0.0,9\n1,1.0,\n2,1.5\n3,2.0,3\n");
        assert_eq!(table.curve("time", "a"), [(0.0, 9.0), (2.0, 3.0)]);
        assert_eq!((table.number("a", 1), table.number("a", 3), table.curve("time", "b")), (None, Some(3.0), vec![]));
    }

    #[test]
    fn columns_that_are_not_wanted_are_not_kept() {
        let table = Columns::chosen(["a,b,c", "1,2,3", "4,5,6"], |name| name != "b");
        assert_eq!((table.column("a"), table.column("b"), table.column("c")), (Some(&[1.0, 4.0][..]), None, Some(&[3.0, 6.0][..])));
    }
}
