//! Places of a path from a file: comma-separated `time,x,y[,z]`, one place a line.

use std::path::Path;

use super::columns::{Format, parse, read_text};
use crate::error::{Error, Result};

/// Names of the columns.
const COLUMNS: [&str; 4] = ["time", "x", "y", "z"];

/// Reads the places of a path in a CSV file: times, each with the displacement then.
///
/// # Errors
/// [`Error::File`] if the file cannot be read and [`Error::Refused`] if its text cannot be used.
pub fn read_places<const D: usize>(path: &Path) -> Result<Vec<Vec<f64>>> {
    let text = read_text(path)?;
    parse_places::<D>(&path.display().to_string(), &text)
}

fn parse_places<const D: usize>(name: &str, text: &str) -> Result<Vec<Vec<f64>>> {
    let mut last: Option<Vec<f64>> = None;
    let row = |numbers: &[f64]| match misplaced(last.as_deref(), numbers) {
        Some(remedy) => Err(format!("{}: {remedy}", numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(","))),
        None => Ok(last.insert(numbers.to_vec()).clone()),
    };
    let places = parse(name, text, &Format { rows: "places", columns: &COLUMNS[..=D], required: D + 1, others: "" }, row)?;
    match places.len() {
        1 => Err(Error::refused(format!("{name}: holds one place; {TOO_FEW}"))),
        _ => Ok(places),
    }
}

/// What is to be done about a path of less than two places.
pub const TOO_FEW: &str = "must hold two places at least, each a time and a displacement";

/// What is to be done about a place that cannot come after the last one, or be the first.
pub fn misplaced(last: Option<&[f64]>, place: &[f64]) -> Option<&'static str> {
    match last {
        None if place.iter().any(|&number| number != 0.0) => Some("must be all zeros: a body starts at time 0 where it is placed"),
        Some(last) if place[0] <= last[0] => Some("must be later than the place before it"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_in_any_order_of_columns() {
        let places = parse_places::<2>("path.csv", "# by hand\nx, time, y\n0,0,0\n1,0.5,2\n").unwrap();
        assert_eq!(places, [[0.0, 0.0, 0.0], [0.5, 1.0, 2.0]]);
        assert_eq!(parse_places::<3>("path.csv", "0,0,0,0\n1,2,3,4").unwrap()[1], [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn refusals_name_the_line_and_what_was_expected() {
        let cases = [
            ("time,x\n0,0", "path.csv:1: the header names no column \"y\""),
            ("time,x,y,z\n0,0,0,0", "path.csv:1: unknown column \"z\"; expected time, x, y"),
            ("0,0\n1,1", "path.csv:1: found 2 columns, expected time,x,y"),
            ("0,0,0\n1,one,1", "path.csv:2: found \"one\" in column x, expected a finite number"),
            ("0,0,0\n1,1,1\n1,2,2", "path.csv:3: 1,2,2: must be later than the place before it"),
            ("time,x,y\n0,0,0.5\n1,1,1", "path.csv:2: 0,0,0.5: must be all zeros: a body starts at time 0 where it is placed"),
            ("time,x,y\n0,0,0\n", "path.csv: holds one place; must hold two places at least, each a time and a displacement"),
            ("time,x,y\n", "path.csv:1: a header but no places below it"),
        ];
        for (text, message) in cases {
            assert_eq!(parse_places::<2>("path.csv", text).unwrap_err().to_string(), message);
        }
    }
}
