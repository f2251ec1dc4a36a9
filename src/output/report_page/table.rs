//! A table of numbers as the page shows it: long ones thinned to the least and the largest value of stretches of rows.

use std::{
    fs::File,
    io::{self, BufRead, BufReader},
    path::Path,
};

use serde::Serialize;

use crate::output::{column_names, row_numbers};

/// Most rows that are shown as they are, and most points of a column of a longer table.
const MOST_POINTS: usize = 1600;

/// Digits of a number.
const DIGITS: usize = 7;

/// Columns of numbers, for charts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Name of the file.
    pub name: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Numbers of each column; nothing where a cell is empty.
    pub values: Vec<Vec<Option<f64>>>,
    /// Rows of the file.
    pub rows: usize,
    /// Rows that every two points stand for; 1 if all rows are shown.
    pub stretch: usize,
}

impl Table {
    /// Reads a file of rows of numbers with commas between them; nothing if it is not there or has no rows.
    ///
    /// The file is read twice, a row at a time, so that a long one takes no memory.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(path: &Path) -> io::Result<Option<Table>> {
        if !path.exists() {
            return Ok(None);
        }
        let rows = lines(path)?.skip(1).filter(|line| line.as_ref().is_ok_and(|line| !line.is_empty())).count();
        let mut all = lines(path)?;
        let Some(header) = all.next().transpose()?.filter(|_| rows > 0) else { return Ok(None) };
        let columns = column_names(&header);
        let stretch = if rows > MOST_POINTS { (2 * rows).div_ceil(MOST_POINTS) } else { 1 };
        let mut table = Table {
            name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            values: vec![Vec::new(); columns.len()],
            columns,
            rows,
            stretch,
        };
        let mut extremes = vec![Extremes::default(); table.columns.len()];
        for (place, line) in all.take(rows).enumerate() {
            let line = line?;
            let mut cells = row_numbers(&line);
            extremes.iter_mut().for_each(|extremes| extremes.add(cells.next().filter(|number| number.is_finite())));
            if (place + 1).is_multiple_of(stretch) || place + 1 == rows {
                table.take(&mut extremes);
            }
        }
        Ok(Some(table))
    }

    /// Whether rows are left out.
    pub fn thinned(&self) -> bool {
        self.stretch > 1
    }

    /// Ends a stretch of rows.
    fn take(&mut self, extremes: &mut [Extremes]) {
        for (values, extremes) in self.values.iter_mut().zip(extremes) {
            let both = std::mem::take(extremes).in_order();
            values.extend(&both[..if self.stretch > 1 { 2 } else { 1 }]);
        }
    }
}

fn lines(path: &Path) -> io::Result<impl Iterator<Item = io::Result<String>>> {
    Ok(BufReader::new(File::open(path)?).lines())
}

/// The least and the largest number of a stretch of a column, and which came first.
#[derive(Debug, Clone, Copy, Default)]
struct Extremes {
    least: Option<(usize, f64)>,
    largest: Option<(usize, f64)>,
    count: usize,
}

impl Extremes {
    fn add(&mut self, number: Option<f64>) {
        if let Some(number) = number {
            let here = Some((self.count, number));
            self.least = self.least.filter(|(_, least)| *least <= number).or(here);
            self.largest = self.largest.filter(|(_, largest)| *largest >= number).or(here);
        }
        self.count += 1;
    }

    fn in_order(self) -> [Option<f64>; 2] {
        let mut both = [self.least, self.largest];
        both.sort_by_key(|extreme| extreme.map(|(place, _)| place));
        both.map(|extreme| extreme.map(|(_, number)| shortened(number)))
    }
}

/// A number without the digits that no chart shows.
fn shortened(number: f64) -> f64 {
    format!("{number:.*e}", DIGITS - 1).parse().expect("digits of a number are a number")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn table(name: &str, text: &str) -> Option<Table> {
        let path = std::env::temp_dir().join(format!("turbid-table-{name}-{}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let table = Table::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        table
    }

    #[test]
    fn a_short_table_is_shown_as_it_is() {
        let table = table("short", "step,gap\n0,\n1,0.123456789\n2,inf\n").unwrap();
        assert_eq!((table.rows, table.stretch), (3, 1));
        assert_eq!(table.values, [vec![Some(0.0), Some(1.0), Some(2.0)], vec![None, Some(0.1234568), None]]);
    }

    #[test]
    fn a_long_table_keeps_its_extremes() {
        let spike = |row: usize| if row == 7777 { 9.0 } else { (row % 2) as f64 };
        let rows: String = (0..20_001).map(|row| format!("{row},{}\n", spike(row))).collect();
        let table = table("long", &format!("step,value\n{rows}")).unwrap();
        let points = table.values[0].len();
        assert!(points <= MOST_POINTS + 2 && points == table.values[1].len() && table.thinned(), "{points}");
        assert!(table.values[1].contains(&Some(9.0)));
        assert_eq!((table.values[0][0], table.values[0][points - 1]), (Some(0.0), Some(20_000.0)));
        assert!(table.values[0].is_sorted());
    }

    #[test]
    fn what_has_no_rows_is_no_table() {
        assert_eq!(table("empty", "step,time\n"), None);
        assert_eq!(Table::read(Path::new("/nowhere/series.csv")).unwrap(), None);
    }
}
