//! Columns of a table of a run, and what stands in them.

use std::{borrow::Cow, rc::Rc};

/// A column of `series.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesColumn {
    /// Its name: small letters, digits and `_`.
    pub name: String,
    /// Its unit in those of the scene; empty for a number without one.
    pub unit: Cow<'static, str>,
    /// What it is, in a sentence.
    pub meaning: Cow<'static, str>,
    /// Whether it is about the suspension, and stands in the summary, or about how the run went.
    pub physical: bool,
}

/// What stands in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// A whole number.
    Count(usize),
    /// Any number.
    Real(f64),
    /// Nothing: a number that does not exist at this time.
    Missing,
}

/// A number in its column.
#[derive(Debug, Clone, PartialEq)]
pub struct SeriesEntry {
    /// The column.
    pub column: Rc<SeriesColumn>,
    /// The number.
    pub number: Number,
}

impl Number {
    /// As a number, if it is there.
    pub fn value(self) -> Option<f64> {
        match self {
            Number::Count(count) => Some(count as f64),
            // a negative zero becomes a positive one
            Number::Real(value) => Some(value + 0.0),
            Number::Missing => None,
        }
    }

    /// The shortest text that reads back as it; empty for nothing.
    pub fn text(self) -> String {
        match self {
            Number::Count(count) => count.to_string(),
            Number::Real(_) | Number::Missing => self.value().map_or(String::new(), |value| format!("{value:?}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_zero_has_no_sign() {
        assert_eq!([-0.0, 0.0, -1.5].map(|value| Number::Real(value).text()), ["0.0", "0.0", "-1.5"]);
        assert_eq!((Number::Count(3).text(), Number::Missing.text()), ("3".into(), String::new()));
    }
}
