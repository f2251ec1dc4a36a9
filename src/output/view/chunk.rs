//! A frame as the page reads it: named columns of whole multiples of a step, deflated.
//!
//! A chunk is, after inflation (zlib), the length of a header as a little-endian `u32`, the header as JSON, and the bytes of the columns, one after the
//! other. The header lists the columns: `{ name, count, bytes, low, step }` stands for `count` numbers `low + step q`, where `q` is a little-endian unsigned whole
//! number of so many `bytes` (no bytes: all are `low`); `{ name, first: true }` stands for the same column of the first frame.

use std::io::Write;

use flate2::{Compression, write::ZlibEncoder};
use serde_json::{Map, Value, json};

/// A frame under way to the page.
#[derive(Debug, Clone, Default)]
pub struct Chunk {
    facts: Map<String, Value>,
    columns: Vec<Column>,
}

#[derive(Debug, Clone, PartialEq)]
struct Column {
    name: String,
    count: usize,
    width: usize,
    low: f64,
    step: f64,
    bytes: Vec<u8>,
}

impl Chunk {
    /// Adds a fact of its own.
    pub fn fact(&mut self, name: &str, value: Value) {
        self.facts.insert(name.to_owned(), value);
    }

    /// Adds a column of numbers, known to `resolution` at least and to one part in 65535 of their range.
    ///
    /// # Errors
    /// What is wrong, when a number is not finite.
    pub fn reals(&mut self, name: &str, values: &[f64], resolution: f64) -> Result<(), String> {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
        if values.iter().any(|value| !value.is_finite()) || (high - low).is_infinite() && !values.is_empty() {
            return Err(format!("its {name} holds numbers that are not finite"));
        }
        let range = if high > low { high - low } else { 0.0 };
        let width = if range == 0.0 {
            0
        } else if range / f64::from(u16::MAX) <= resolution {
            2
        } else {
            4
        };
        let step = range / if width == 4 { f64::from(u32::MAX) } else { f64::from(u16::MAX) };
        self.add(name, values, width, if values.is_empty() { 0.0 } else { low }, step);
        Ok(())
    }

    /// Adds a column of whole numbers.
    pub fn wholes(&mut self, name: &str, values: impl Iterator<Item = i64>) {
        let values: Vec<f64> = values.map(|value| value as f64).collect();
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
        let width = match high - low {
            range if range > f64::from(u16::MAX) => 4,
            range if range > f64::from(u8::MAX) => 2,
            range if range > 0.0 => 1,
            _ => 0,
        };
        self.add(name, &values, width, if values.is_empty() { 0.0 } else { low }, 1.0);
    }

    fn add(&mut self, name: &str, values: &[f64], width: usize, low: f64, step: f64) {
        let quotient = |value: &f64| (((value - low) / step).round() as u32).to_le_bytes();
        let bytes = if width == 0 { Vec::new() } else { values.iter().flat_map(|value| quotient(value).into_iter().take(width)).collect() };
        self.columns.push(Column { name: name.to_owned(), count: values.len(), width, low, step, bytes });
    }

    /// The bytes of the chunk, without the columns that are the same in the `first` frame, if this is another.
    pub fn packed(&self, first: Option<&Chunk>) -> Vec<u8> {
        let same = |column: &&Column| first.is_some_and(|first| first.columns.contains(column));
        let describe = |column: &Column| match same(&column) {
            true => json!({ "name": column.name, "first": true }),
            false => json!({ "name": column.name, "count": column.count, "bytes": column.width, "low": column.low, "step": column.step }),
        };
        let mut header = self.facts.clone();
        header.insert("columns".to_owned(), self.columns.iter().map(describe).collect());
        let header = Value::Object(header).to_string();
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        let own = self.columns.iter().filter(|column| !same(column)).map(|column| column.bytes.as_slice());
        let length = (header.len() as u32).to_le_bytes();
        let parts = [&length[..], header.as_bytes()].into_iter().chain(own);
        parts.into_iter().try_for_each(|part| encoder.write_all(part)).expect("a vector takes any bytes");
        encoder.finish().expect("a vector takes any bytes")
    }
}

/// Bytes as letters, digits, `+` and `/` (RFC 4648).
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let quartet = |group: &[u8]| {
        let word = (0..3).fold(0u32, |word, k| word << 8 | u32::from(group.get(k).copied().unwrap_or(0)));
        let group = group.len();
        std::array::from_fn::<char, 4, _>(|k| if k <= group { char::from(LETTERS[(word >> (18 - 6 * k) & 63) as usize]) } else { '=' })
    };
    bytes.chunks(3).flat_map(quartet).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn letters_stand_for_bytes() {
        let words = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|word| base64(word.as_bytes()));
        assert_eq!(words, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
        assert_eq!(base64(&[255, 254, 253]), "//79");
    }

    #[test]
    fn a_column_is_as_wide_as_it_must_be() {
        let mut chunk = Chunk::default();
        chunk.reals("equal", &[0.5, 0.5], 1e-9).unwrap();
        chunk.reals("coarse", &[0.0, 1.0], 1e-3).unwrap();
        chunk.reals("fine", &[0.0, 1.0], 1e-6).unwrap();
        chunk.reals("none", &[], 1e-6).unwrap();
        chunk.wholes("few", [-1, 3].into_iter());
        chunk.wholes("many", [0, 70_000].into_iter());
        assert_eq!(chunk.columns.iter().map(|column| column.width).collect::<Vec<_>>(), [0, 2, 4, 0, 1, 4]);
        assert!(chunk.reals("broken", &[f64::NAN, 1.0], 1.0).is_err());
        assert!(chunk.reals("broken", &[f64::MAX, -f64::MAX], 1.0).is_err());
    }

    #[test]
    fn what_does_not_change_is_stored_once() {
        let mut chunk = Chunk::default();
        chunk.wholes("bodies", (0..10_000).map(|k| k * 7919 % 10_007));
        assert!(chunk.packed(Some(&chunk)).len() < 100);
        assert!(chunk.packed(None).len() > 10_000);
    }
}
