//! A reader for values of a scene file that refuses what is not right with key, value and remedy.

use toml_edit::Value;

use crate::body::usable;
use crate::error::{Error, Result};
use crate::scene::elsewhere;
use crate::scene::locations::{Locations, join};
use crate::scene::nearest::nearest;

/// The longest value a message repeats in full.
const LONGEST: usize = 60;

/// One value and the path of its key.
pub(super) struct Entry<'a> {
    pub(super) value: &'a Value,
    pub(super) key: String,
    pub(super) locations: &'a Locations,
}

impl<'a> Entry<'a> {
    pub(super) fn refuse(&self, remedy: &str) -> Error {
        self.locations.refuse(&self.key, shown(self.value), remedy)
    }

    pub(super) fn number(&self) -> Result<f64> {
        let number = match self.value {
            Value::Integer(number) => *number.value() as f64,
            Value::Float(number) => *number.value(),
            _ => return Err(self.mistyped("a number")),
        };
        self.expect((), number.is_finite(), "must be finite")?;
        self.expect(
            number,
            usable(number),
            "must be 0 or from 1e-60 to 1e60 in size, so that it can be multiplied by others; choose other units",
        )
    }

    pub(super) fn positive(&self) -> Result<f64> {
        let number = self.number()?;
        self.expect(number, number > 0.0, "must be positive")
    }

    pub(super) fn not_negative(&self) -> Result<f64> {
        let number = self.number()?;
        self.expect(number, number >= 0.0, "must not be negative")
    }

    pub(super) fn whole(&self, least: u64) -> Result<u64> {
        let number = self.value.as_integer().ok_or_else(|| self.mistyped("a whole number"))?;
        let number = u64::try_from(number).ok().filter(|&number| number >= least);
        number.ok_or_else(|| self.refuse(&format!("must be at least {least}")))
    }

    pub(super) fn count(&self) -> Result<usize> {
        let number = self.whole(1)?;
        usize::try_from(number).map_err(|_| self.refuse("is too large for this machine"))
    }

    pub(super) fn text(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.mistyped("a text in quotes"))
    }

    pub(super) fn flag(&self) -> Result<bool> {
        self.value.as_bool().ok_or_else(|| self.mistyped("true or false"))
    }

    /// One of the available words; the planned ones are refused as such.
    pub(super) fn choice<T: Copy>(&self, available: &[(&str, T)], planned: &[&str]) -> Result<T> {
        let names = listed(available.iter().map(|(name, _)| format!("{name:?}")).collect());
        let text = self.value.as_str().ok_or_else(|| self.mistyped(&names))?;
        let found = available.iter().find(|(name, _)| *name == text).map(|&(_, choice)| choice);
        found.ok_or_else(|| match planned.contains(&text) {
            true => self.refuse(&format!("is not available yet; must be {names}")),
            false => self.refuse(&format!("must be {names}{}", self.guess(text, available.iter().map(|(name, _)| *name)))),
        })
    }

    /// What a word that is none of the available ones may stand for.
    pub(super) fn guess<'w>(&self, word: &str, available: impl IntoIterator<Item = &'w str>) -> String {
        match nearest(&word.to_lowercase(), available) {
            Some(known) => format!("; did you mean {known:?}?"),
            None => elsewhere::answer_to_value(&self.key, word).map_or(String::new(), |answer| format!("; {answer}")),
        }
    }

    pub(super) fn list(&self) -> Result<Vec<Entry<'a>>> {
        let array = self.value.as_array().ok_or_else(|| self.mistyped("a list"))?;
        let entry = |(index, value)| Entry { value, key: join(&self.key, index), locations: self.locations };
        Ok(array.iter().enumerate().map(entry).collect())
    }

    pub(super) fn vector(&self, length: usize) -> Result<Vec<f64>> {
        let expected = format!("a list of {length} numbers");
        let array = self.value.as_array().ok_or_else(|| self.mistyped(&expected))?;
        if array.len() != length {
            return Err(self.refuse(&format!("must be {expected}, one for each dimension of domain.size")));
        }
        self.list()?.iter().map(Entry::number).collect()
    }

    /// A turning rate or a torque: a number in 2D, three numbers in 3D.
    pub(super) fn rotation(&self, dimension: usize) -> Result<Vec<f64>> {
        if dimension == 2 { Ok(vec![self.number()?]) } else { self.vector(3) }
    }

    pub(super) fn expect<T>(&self, value: T, right: bool, remedy: &str) -> Result<T> {
        if right { Ok(value) } else { Err(self.refuse(remedy)) }
    }

    pub(super) fn mistyped(&self, expected: &str) -> Error {
        let found = match self.value {
            Value::String(_) => "a text",
            Value::Integer(_) => "a whole number",
            Value::Float(_) => "a decimal number",
            Value::Boolean(_) => "true or false",
            Value::Datetime(_) => "a date",
            Value::Array(_) => "a list",
            Value::InlineTable(_) => "a table",
        };
        self.refuse(&format!("must be {expected}, not {found}"))
    }
}

/// The word for a choice in a scene file.
pub(super) fn word_of<T: PartialEq>(words: &[(&'static str, T)], choice: &T) -> &'static str {
    words.iter().find(|(_, of)| of == choice).map_or("", |(word, _)| word)
}

/// `a`, `a or b`, `a, b or c`.
fn listed(mut names: Vec<String>) -> String {
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} or {last}", names.join(", ")) }
}

/// A value as messages repeat it: on one line and not too long.
fn shown(value: &Value) -> String {
    let text = value.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text,
    }
}
