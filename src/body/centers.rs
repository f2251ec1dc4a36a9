//! Centres from a file: comma-separated `x,y[,z][,radius]`, one body a line.

use std::{fs, io, path::Path};

use nalgebra::SVector;

use crate::error::{Error, Result};

/// A body as a file gives it: its centre and, if the file has that column, its radius.
type Entry<const D: usize> = (SVector<f64, D>, Option<f64>);

/// Reads the centres, and the radii if given, of the bodies in a CSV file; see [`parse_centers`].
///
/// Returns [`Error::File`] if the file cannot be read and [`Error::Refused`] if its text cannot be used.
pub fn read_centers<const D: usize>(path: &Path) -> Result<Vec<(SVector<f64, D>, Option<f64>)>> {
    let text = read_text(path)?;
    parse_centers(&path.display().to_string(), &text)
}

/// The text of a file that a user names. A pipe or a device, which may never end and which only one rank could read, is none.
///
/// # Errors
/// [`Error::File`] if it cannot be read, or is no regular file.
pub fn read_text(path: &Path) -> Result<String> {
    let read = || match fs::metadata(path)? {
        metadata if metadata.is_file() => fs::read_to_string(path),
        metadata if metadata.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        _ => Err(io::Error::other("is no regular file; copy what it gives into one")),
    };
    read().map_err(|source| Error::File { path: path.to_owned(), source })
}

/// Parses the text of a file of centres, one body a line.
///
/// The columns are `x,y[,z][,radius]`, in any order if the first line names them. Commas part them, or semicolons, or else tabs and spaces; spaces
/// around commas and semicolons mean nothing. Blank lines and lines that start with `#` are skipped. Refusals begin with `name` and the line number.
pub fn parse_centers<const D: usize>(name: &str, text: &str) -> Result<Vec<(SVector<f64, D>, Option<f64>)>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let refuse = |number: usize, reason: String| Error::refused(format!("{name}:{number}: {reason}"));
    let Some(&(number, first)) = lines.peek() else {
        return Err(Error::refused(format!("{name}: no centres found; expected lines of {}", choices::<D>().join(","))));
    };
    let separator = Separator::of(first).map_err(|reason| refuse(number, reason))?;
    let names = separator.fields(first);
    let columns = if is_header(&names) {
        lines.next();
        header_columns::<D>(&names)
    } else {
        default_columns::<D>(names.len())
    }
    .map_err(|reason| refuse(number, reason))?;
    let entries: Vec<_> = lines
        .map(|(number, line)| entry(&columns, &separator.fields(line)).map_err(|reason| refuse(number, reason)))
        .collect::<Result<_>>()?;
    match entries.is_empty() {
        true => Err(refuse(number, "a header but no centres below it".into())),
        false => Ok(entries),
    }
}

/// Names a column may have: the coordinates, then the radius.
fn choices<const D: usize>() -> Vec<&'static str> {
    let coordinates = ["x", "y", "z"];
    coordinates.into_iter().take(D).chain(["radius"]).collect()
}

/// What parts the columns of a file.
#[derive(Clone, Copy)]
enum Separator {
    Sign(char),
    Blanks,
}

impl Separator {
    /// That of a line: the others have the same.
    fn of(line: &str) -> std::result::Result<Separator, String> {
        match (line.contains(','), line.contains(';')) {
            (true, true) => {
                Err("has both commas and semicolons; write numbers with decimal points, and one of both between columns".into())
            }
            (true, false) => Ok(Separator::Sign(',')),
            (false, true) => Ok(Separator::Sign(';')),
            (false, false) => Ok(Separator::Blanks),
        }
    }

    fn fields(self, line: &str) -> Vec<&str> {
        match self {
            Separator::Sign(sign) => line.split(sign).map(str::trim).collect(),
            Separator::Blanks => line.split_whitespace().collect(),
        }
    }
}

fn is_header(fields: &[&str]) -> bool {
    fields.iter().all(|field| !field.is_empty() && field.parse::<f64>().is_err())
}

/// For each column of the file its place among the choices, from the names in the header.
fn header_columns<const D: usize>(fields: &[&str]) -> std::result::Result<Vec<usize>, String> {
    let choices = choices::<D>();
    let mut columns = Vec::new();
    for field in fields {
        let column = choices.iter().position(|choice| field.eq_ignore_ascii_case(choice));
        let column = column.ok_or_else(|| format!("unknown column {}; expected {}", quoted(field), choices.join(", ")))?;
        if columns.contains(&column) {
            return Err(format!("column {} appears twice", quoted(field)));
        }
        columns.push(column);
    }
    match (0..D).find(|axis| !columns.contains(axis)) {
        Some(axis) => Err(format!("the header names no column {:?}", choices[axis])),
        None => Ok(columns),
    }
}

/// Columns in the usual order, with a radius if the first line has one number more than coordinates.
fn default_columns<const D: usize>(count: usize) -> std::result::Result<Vec<usize>, String> {
    if count == D || count == D + 1 {
        return Ok((0..count).collect());
    }
    Err(format!("found {count} columns, expected {} with or without radius", choices::<D>().join(",")))
}

/// The centre and radius on one line.
fn entry<const D: usize>(columns: &[usize], fields: &[&str]) -> std::result::Result<Entry<D>, String> {
    let count = fields.len();
    if count != columns.len() {
        return Err(format!("found {count} columns, expected {} as in the first line", columns.len()));
    }
    let mut center = SVector::zeros();
    let mut radius = None;
    for (field, &column) in fields.iter().zip(columns) {
        let number = finite(field)?;
        if column < D {
            center[column] = number;
        } else if number > 0.0 {
            radius = Some(number);
        } else {
            return Err(format!("found radius {field}, expected a positive number"));
        }
    }
    Ok((center, radius))
}

fn finite(field: &str) -> std::result::Result<f64, String> {
    let number = field.parse::<f64>().ok().filter(|number| number.is_finite());
    let decimal = if field.contains(',') { "; write decimal points" } else { "" };
    let number = number.ok_or_else(|| format!("found {}, expected a finite number{decimal}", quoted(field)))?;
    match usable(number) {
        true => Ok(number),
        false => Err(format!("found {}, expected 0 or a number from 1e-60 to 1e60 in size", quoted(field))),
    }
}

/// Whether a number can be multiplied by others of its size: a product of five such numbers is still one.
pub fn usable(number: f64) -> bool {
    number == 0.0 || (1e-60..=1e60).contains(&number.abs())
}

/// The beginning of a field, in quotes.
fn quoted(field: &str) -> String {
    format!("{:?}", field.chars().take(40).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let expected: [Entry<2>; 2] = [([3.0, 2.0].into(), Some(0.1)), ([5.0, 4.0].into(), Some(0.2))];
        assert_eq!(centers, expected);
    }

    #[test]
    fn a_last_column_without_header_is_the_radius() {
        let centers = parse_centers::<3>("c.csv", "\u{feff}1,2,3,0.5\r\n4,5,6,0.5\r\n").unwrap();
        assert_eq!(centers[1], ([4.0, 5.0, 6.0].into(), Some(0.5)));
    }

    #[test]
    fn columns_may_be_parted_by_spaced_commas_semicolons_tabs_and_spaces() {
        let expected: [Entry<2>; 2] = [([1.0, 2.5].into(), Some(0.5)), ([-3.0, 4.0].into(), Some(0.25))];
        let texts = [
            " x , y, radius\n 1 , 2.5 ,0.5 \n-3,  4, 0.25",
            "x;y;radius\n1; 2.5;0.5\n-3;4;0.25",
            "x\ty\tradius\n1\t2.5\t0.5\n-3\t4\t0.25",
            "1 2.5   0.5\n-3 4 0.25",
        ];
        for text in texts {
            assert_eq!(parse_centers::<2>("c.csv", text).unwrap(), expected, "{text}");
        }
        assert!(refusal::<2>("1,5;2,5").contains("write numbers with decimal points"), "{}", refusal::<2>("1,5;2,5"));
    }

    #[test]
    fn refusals_name_the_line_and_what_was_expected() {
        let cases = [
            ("1,2\n3,abc", "c.csv:2: found \"abc\", expected a finite number"),
            ("1,2\n3,inf", "c.csv:2: found \"inf\", expected a finite number"),
            ("1,2\n3,", "c.csv:2: found \"\", expected a finite number"),
            ("1,2\n\n3,4,5", "c.csv:3: found 3 columns, expected 2 as in the first line"),
            ("1,2,-1", "c.csv:1: found radius -1, expected a positive number"),
            ("x,y,mass\n1,2,3", "c.csv:1: unknown column \"mass\"; expected x, y, radius"),
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
        fn no_text_panics(text in "\\PC*", lines in "([xyz0-9.,eE+# \n-]|radius|nan|inf){0,60}") {
            for text in [text, lines] {
                let _ = parse_centers::<2>("c.csv", &text);
                let _ = parse_centers::<3>("c.csv", &text);
            }
        }

        #[test]
        fn what_is_written_is_read(points in prop::collection::vec((-1e9..1e9, -1e9..1e9, 1e-9..1e9), 1..20)) {
            let lines: Vec<_> = points.iter().map(|(x, y, radius)| format!("{x},{y},{radius}")).collect();
            let centers = parse_centers::<2>("c.csv", &lines.join("\n")).unwrap();
            let expected: Vec<Entry<2>> = points.iter().map(|&(x, y, radius)| ([x, y].into(), Some(radius))).collect();
            prop_assert_eq!(centers, expected);
        }
    }
}
