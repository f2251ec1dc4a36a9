//! Centres from a file: comma-separated `x,y[,z][,radius]`, one body a line.

use std::path::Path;

use nalgebra::SVector;

use super::columns::{Format, parse, read_text};
use crate::error::Result;

/// A body as a file gives it: its centre and, if the file has that column, its radius.
type ListedCenter<const D: usize> = (SVector<f64, D>, Option<f64>);

/// Names of the columns.
const COLUMNS: [&str; 4] = ["x", "y", "z", "radius"];

/// What to do about a column of another name.
const OTHERS: &str =
    "; leave it out; density, velocity and the like are keys of a group: write one group for each value, with a file of its own";

/// Reads the centres, and the radii if given, of the bodies in a CSV file; see [`parse_centers`].
///
/// Returns [`Error::File`](crate::error::Error::File) if the file cannot be read and [`Error::Refused`](crate::error::Error::Refused) if its text cannot be used.
pub fn read_centers<const D: usize>(path: &Path) -> Result<Vec<(SVector<f64, D>, Option<f64>)>> {
    let text = read_text(path)?;
    parse_centers(&path.display().to_string(), &text)
}

/// Parses the text of a file of centres, one body a line, with the columns `x,y[,z][,radius]`.
pub fn parse_centers<const D: usize>(name: &str, text: &str) -> Result<Vec<(SVector<f64, D>, Option<f64>)>> {
    let columns: Vec<&str> = COLUMNS[..D].iter().chain(&COLUMNS[3..]).copied().collect();
    parse(name, text, &Format { rows: "centres", columns: &columns, required: D, others: OTHERS }, entry)
}

/// The centre and radius on one line.
fn entry<const D: usize>(numbers: &[f64]) -> std::result::Result<ListedCenter<D>, String> {
    let (center, radius) = numbers.split_at(D);
    match radius.first() {
        Some(radius) if *radius <= 0.0 => Err(format!("found radius {radius}, expected a positive number")),
        radius => Ok((SVector::from_column_slice(center), radius.copied())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use proptest::prelude::*;

    fn refusal<const D: usize>(text: &str) -> String {
        parse_centers::<D>("c.csv", text).unwrap_err().to_string()
    }

    #[test]
    fn the_reference_file_has_thirty_disks() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/random30_disks.csv");
        let centers = read_centers::<2>(&path).unwrap();
        assert_eq!(centers.len(), 30);
        assert_eq!(centers[0], ([0.648292203122, 0.858113343446].into(), None));
    }

    #[test]
    fn a_header_orders_the_columns() {
        let text = "# made by hand\n\nradius, Y ,x\n0.1,2,3\n\n0.2,4,5\n";
        let centers = parse_centers::<2>("c.csv", text).unwrap();
        let expected: [ListedCenter<2>; 2] = [([3.0, 2.0].into(), Some(0.1)), ([5.0, 4.0].into(), Some(0.2))];
        assert_eq!(centers, expected);
    }

    #[test]
    fn a_last_column_without_header_is_the_radius() {
        let centers = parse_centers::<3>("c.csv", "\u{feff}1,2,3,0.5\r\n4,5,6,0.5\r\n").unwrap();
        assert_eq!(centers[1], ([4.0, 5.0, 6.0].into(), Some(0.5)));
    }

    #[test]
    fn columns_may_be_parted_by_spaced_commas_semicolons_tabs_and_spaces_and_stand_in_quotes() {
        let expected: [ListedCenter<2>; 2] = [([1.0, 2.5].into(), Some(0.5)), ([-3.0, 4.0].into(), Some(0.25))];
        let texts = [
            " x , y, radius\n 1 , 2.5 ,0.5 \n-3,  4, 0.25",
            "x;y;radius\n1; 2.5;0.5\n-3;4;0.25",
            "x\ty\tradius\n1\t2.5\t0.5\n-3\t4\t0.25",
            "1 2.5   0.5\n-3 4 0.25",
        ];
        for text in texts {
            assert_eq!(parse_centers::<2>("c.csv", text).unwrap(), expected, "{text}");
        }
        let quoted = ["\"x\",\"y\",\"radius\"\n1,2.5,0.5\n-3,4,0.25", "\"x\" \"y\" \"radius\"\n\"1\" \"2.5\" 0.5\n-3 4 \"0.25\""];
        for text in quoted {
            assert_eq!(parse_centers::<2>("c.csv", text).unwrap(), expected, "{text}");
        }
        assert!(refusal::<2>("1,5;2,5").contains("write numbers with decimal points"), "{}", refusal::<2>("1,5;2,5"));
    }

    #[test]
    fn refusals_name_the_line_and_what_was_expected() {
        let cases = [
            ("1,2\n3,abc", "c.csv:2: found \"abc\" in column y, expected a finite number"),
            ("1,2\n3,inf", "c.csv:2: found \"inf\" in column y, expected a finite number"),
            ("1,2\n3,", "c.csv:2: found \"\" in column y, expected a finite number"),
            ("1,2\n\n3,4,5", "c.csv:3: found 3 columns, expected 2 as in the first line"),
            ("1,2,-1", "c.csv:1: found radius -1, expected a positive number"),
            (
                "x,y,mass\n1,2,3",
                "c.csv:1: unknown column \"mass\"; expected x, y, radius; leave it out; density, velocity and the like are keys of a group: write one \
                 group for each value, with a file of its own",
            ),
            (
                "\"\",\"x\",\"y\"\n\"1\",1,2",
                "c.csv:1: the first column has no name; leave out row names: in R write.csv(.., row.names = FALSE), in pandas to_csv(.., index=False)",
            ),
            (
                "\"x\" \"y\"\n\"1\" 1 2",
                "c.csv:2: found 3 columns, expected 2 as in the first line; leave out row names: in R write.csv(.., row.names = FALSE), in pandas \
                 to_csv(.., index=False)",
            ),
            ("\"x\",\"y\"\n1,\"2", "c.csv:2: found \"\\\"2\" in column y, expected a finite number"),
            ("x,x\n1,2", "c.csv:1: column \"x\" appears twice"),
            ("x,radius\n1,2", "c.csv:1: the header names no column \"y\""),
            ("1,2,3,4", "c.csv:1: found 4 columns, expected x,y,radius with or without radius"),
            ("#\n", "c.csv: no centres found; expected lines of x,y,radius"),
            ("#\nx,y\n", "c.csv:2: a header but no centres below it"),
        ];
        for (text, message) in cases {
            assert_eq!(refusal::<2>(text), message);
        }
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let error = read_centers::<2>(Path::new("no/such.csv")).unwrap_err();
        assert!(matches!(error, Error::File { .. }));
        assert!(error.to_string().starts_with("no/such.csv"));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

        #[test]
        fn no_text_panics(text in "\\PC*", lines in "([xyz0-9.,eE+# \"\n-]|radius|nan|inf){0,60}") {
            for text in [text, lines] {
                let _ = parse_centers::<2>("c.csv", &text);
                let _ = parse_centers::<3>("c.csv", &text);
            }
        }

        #[test]
        fn what_is_written_is_read(points in prop::collection::vec((-1e9..1e9, -1e9..1e9, 1e-9..1e9), 1..20)) {
            let lines: Vec<_> = points.iter().map(|(x, y, radius)| format!("{x},{y},{radius}")).collect();
            let centers = parse_centers::<2>("c.csv", &lines.join("\n")).unwrap();
            let expected: Vec<ListedCenter<2>> = points.iter().map(|&(x, y, radius)| ([x, y].into(), Some(radius))).collect();
            prop_assert_eq!(centers, expected);
        }
    }
}
