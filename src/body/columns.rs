//! Tables of numbers in text files: what parts columns, names of columns, and lines that mean nothing.

use std::{fs, io, path::Path};

use crate::error::{Error, Result};

/// What a table may hold.
pub struct Format<'a> {
    /// What its lines are, for messages.
    pub rows: &'a str,
    /// Names of its columns.
    pub columns: &'a [&'a str],
    /// How many of these it must have; the others may be absent together.
    pub required: usize,
    /// What to do about a column of another name.
    pub others: &'a str,
}

/// What to do about the row names that R writes without being asked.
const ROW_NAMES: &str = "leave out row names: in R write.csv(.., row.names = FALSE), in pandas to_csv(.., index=False)";

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

/// Parses a table; `row` makes something of the numbers of a line, which are in the order of the columns, or says why it cannot.
///
/// Columns are in any order if the first line names them. Commas part them, or semicolons, or else tabs and spaces; spaces around commas and semicolons
/// mean nothing, and so do double quotes around a name or a number. Blank lines and lines that start with `#` are skipped. Refusals begin with `name` and the
/// line number.
pub fn parse<T>(name: &str, text: &str, format: &Format, mut row: impl FnMut(&[f64]) -> std::result::Result<T, String>) -> Result<Vec<T>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let refuse = |number: usize, reason: String| Error::refused(format!("{name}:{number}: {reason}"));
    let Some(&(number, first)) = lines.peek() else {
        return Err(Error::refused(format!("{name}: no {} found; expected lines of {}", format.rows, format.columns.join(","))));
    };
    let separator = Separator::of(first).map_err(|reason| refuse(number, reason))?;
    let names = separator.fields(first);
    let columns = match &names[..] {
        ["", others @ ..] if is_header(others) => Err(format!("the first column has no name; {ROW_NAMES}")),
        names if is_header(names) => {
            lines.next();
            format.header_columns(names)
        }
        names => format.default_columns(names.len()),
    }
    .map_err(|reason| refuse(number, reason))?;
    let read = |line: &str| numbers(format, &columns, &separator.fields(line)).map_err(|reason| named_row(reason, line, columns.len()));
    let mut made = |line: &str| row(&read(line)?);
    let rows: Vec<T> = lines.map(|(number, line)| made(line).map_err(|reason| refuse(number, reason))).collect::<Result<_>>()?;
    match rows.is_empty() {
        true => Err(refuse(number, format!("a header but no {} below it", format.rows))),
        false => Ok(rows),
    }
}

impl Format<'_> {
    /// For each column of the file its place among those of the format, from the names in the header.
    fn header_columns(&self, fields: &[&str]) -> std::result::Result<Vec<usize>, String> {
        let mut columns = Vec::new();
        for field in fields {
            let column = self.columns.iter().position(|name| field.eq_ignore_ascii_case(name));
            let column =
                column.ok_or_else(|| format!("unknown column {}; expected {}{}", quoted(field), self.columns.join(", "), self.others))?;
            if columns.contains(&column) {
                return Err(format!("column {} appears twice", quoted(field)));
            }
            columns.push(column);
        }
        match (0..self.required).find(|column| !columns.contains(column)) {
            Some(column) => Err(format!("the header names no column {:?}", self.columns[column])),
            None => Ok(columns),
        }
    }

    /// Columns in the usual order, those that may be absent if the first line has as many numbers.
    fn default_columns(&self, count: usize) -> std::result::Result<Vec<usize>, String> {
        let (all, other) = (self.columns.join(","), self.columns[self.required..].join(","));
        match other.as_str() {
            _ if count == self.required || count == self.columns.len() => Ok((0..count).collect()),
            "" => Err(format!("found {count} columns, expected {all}")),
            other => Err(format!("found {count} columns, expected {all} with or without {other}")),
        }
    }
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
            Separator::Sign(sign) => line.split(sign).map(unquoted).collect(),
            Separator::Blanks => line.split_whitespace().map(unquoted).collect(),
        }
    }
}

/// A field without the blanks and the double quotes around it.
fn unquoted(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|field| field.strip_suffix('"')).map_or(field, str::trim)
}

fn is_header(fields: &[&str]) -> bool {
    !fields.is_empty() && fields.iter().all(|field| !field.is_empty() && field.parse::<f64>().is_err())
}

/// Why a line cannot be used, with a remedy where it begins with a name in quotes besides the columns of the header, as R's `write.table` has it.
fn named_row(reason: String, line: &str, columns: usize) -> String {
    let fields = Separator::of(line).map_or(0, |separator| separator.fields(line).len());
    if line.starts_with('"') && fields == columns + 1 { format!("{reason}; {ROW_NAMES}") } else { reason }
}

/// The numbers on one line, in the order of the columns of the format.
fn numbers(format: &Format, columns: &[usize], fields: &[&str]) -> std::result::Result<Vec<f64>, String> {
    if fields.len() != columns.len() {
        return Err(format!("found {} columns, expected {} as in the first line", fields.len(), columns.len()));
    }
    let mut numbers = vec![0.0; columns.len()];
    for (field, &column) in fields.iter().zip(columns) {
        numbers[column] = finite(format.columns[column], field)?;
    }
    Ok(numbers)
}

fn finite(column: &str, field: &str) -> std::result::Result<f64, String> {
    let number = field.parse::<f64>().ok().filter(|number| number.is_finite());
    let decimal = if field.contains(',') { "; write decimal points" } else { "" };
    let number = number.ok_or_else(|| format!("found {} in column {column}, expected a finite number{decimal}", quoted(field)))?;
    match usable(number) {
        true => Ok(number),
        false => Err(format!("found {} in column {column}, expected 0 or a number from 1e-60 to 1e60 in size", quoted(field))),
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
