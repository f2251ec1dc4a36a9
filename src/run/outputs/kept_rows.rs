//! What a run that goes on keeps of a table.

use std::{fs, io::ErrorKind, path::Path};

use crate::error::{Error, Result};

/// The header and the whole rows that are kept for their first number, and how many these are; a run begins with none.
///
/// # Errors
/// A line is no row, or has not as many cells as the header, or its first number is below that before it.
pub fn kept_lines(path: &Path, keep: &dyn Fn(f64) -> bool) -> Result<(String, usize)> {
    let bytes = match fs::read(path) {
        Err(source) if source.kind() == ErrorKind::NotFound => return Ok((String::new(), 0)),
        _ if !keep(0.0) => return Ok((String::new(), 0)),
        bytes => bytes.map_err(|source| Error::File { path: path.to_owned(), source })?,
    };
    let text = String::from_utf8_lossy(&bytes);
    let refuse = |line: usize, what: &str| {
        let path = path.display();
        Error::refused(format!("{path}:{line}: {what}; put the file back, or remove it to go on without the rows so far"))
    };
    let (mut kept, mut rows, mut width, mut before) = (String::new(), 0, 0, f64::NEG_INFINITY);
    for (number, line) in (1..).zip(text.split_inclusive('\n').filter(|line| line.ends_with('\n'))) {
        let cells: Vec<&str> = line.trim_end_matches('\n').split(',').collect();
        if number == 1 {
            width = cells.len();
        } else {
            let first =
                cells[0].parse::<f64>().ok().filter(|first| *first >= before).ok_or_else(|| refuse(number, "is no row of a series"))?;
            if !keep(first) {
                break;
            }
            if cells.len() != width {
                return Err(refuse(number, &format!("has {} cells, and the header has {width} names", cells.len())));
            }
            (before, rows) = (first, rows + 1);
        }
        kept.push_str(line);
    }
    Ok((if rows > 0 { kept } else { String::new() }, rows))
}
