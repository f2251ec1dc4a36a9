//! Cells of a row of a table.

use std::{borrow::Cow, path::Path};

use crate::{error::Result, output::not_finite};

/// The name and the text of a cell; one without a number is empty.
pub type Cell = (Cow<'static, str>, String);

/// A whole number.
pub fn count(name: impl Into<Cow<'static, str>>, count: usize) -> Cell {
    (name.into(), count.to_string())
}

/// The shortest text that reads back as the number; zero has no sign.
pub fn real(name: impl Into<Cow<'static, str>>, value: f64) -> Cell {
    (name.into(), format!("{:?}", value + 0.0))
}

/// A number that is not there.
pub fn absent(name: impl Into<Cow<'static, str>>) -> Cell {
    (name.into(), String::new())
}

/// A number, or an empty cell where it is not finite.
pub fn finite(name: impl Into<Cow<'static, str>>, value: f64) -> Cell {
    if value.is_finite() { real(name, value) } else { absent(name) }
}

/// Refuses a row of which a number is not finite; an empty cell has none.
pub fn refuse_infinite(path: &Path, cells: &[Cell]) -> Result<()> {
    let value = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let broken = cells.iter().find(|(_, text)| !text.is_empty() && !value(text).is_finite());
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    broken.map_or(Ok(()), |(name, text)| Err(not_finite(&file, name, value(text))))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_not_there_passes_and_one_that_is_not_finite_does_not() {
        let path = Path::new("out/series.csv");
        assert!(refuse_infinite(path, &[count("step", 3), absent("smallest_gap"), finite("seconds", 0.5)]).is_ok());
        let refusal = refuse_infinite(path, &[real("time", f64::INFINITY)]).unwrap_err().to_string();
        assert!(refusal.contains("series.csv") && refusal.contains("time"), "{refusal}");
    }
}
