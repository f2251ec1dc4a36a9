//! Keys that a sweep varies, and the points that they make.

use crate::error::{Error, Result};

/// A key and the value that it is given.
pub type Assignment = (String, String);

/// A key with the values that it takes in turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Vary {
    /// The key, as `--set` takes it.
    pub key: String,
    /// Its values, as `--set` takes them.
    pub values: Vec<String>,
}

impl Vary {
    /// From `key=a,b,c`; commas within brackets, braces and quotes separate nothing.
    ///
    /// # Errors
    /// [`Error::Refused`] for a text without a key or a value.
    pub fn parse(text: &str) -> Result<Vary> {
        let refuse = |reason: &str| Error::refused(format!("--vary \"{}\": {reason}", text.escape_debug()));
        let malformed = || refuse("must be key=value,value,.., for example resolution.cells_per_radius=4,6,8");
        let (key, values) = text.split_once('=').ok_or_else(malformed)?;
        let values = split(values);
        if key.trim().is_empty() || values.iter().any(String::is_empty) {
            return Err(malformed());
        }
        if let Some(range) = values.iter().find(|value| is_range(value)) {
            return Err(refuse(&format!(
                "{range} is no list of values; there are no ranges: separate all values by commas, as {key}=0.1,0.2,0.3"
            )));
        }
        match (1..values.len()).find(|&place| values[..place].contains(&values[place])) {
            Some(place) => Err(refuse(&format!("holds {} twice; name each value once", values[place]))),
            None => Ok(Vary { key: key.trim().to_owned(), values }),
        }
    }

    /// All keys of a command line.
    ///
    /// # Errors
    /// [`Error::Refused`] if one cannot be read or stands there twice.
    pub fn parse_all(texts: &[String]) -> Result<Vec<Vary>> {
        let all = texts.iter().map(|text| Vary::parse(text)).collect::<Result<Vec<_>>>()?;
        match (1..all.len()).find(|&place| all[..place].iter().any(|other| other.key == all[place].key)) {
            Some(place) => Err(Error::refused(format!("--vary {}: is varied twice; list all its values in one --vary", all[place].key))),
            None => Ok(all),
        }
    }
}

/// Every combination of the values, the last key changing fastest.
pub fn points(all: &[Vary]) -> Vec<Vec<Assignment>> {
    all.iter().fold(vec![Vec::new()], |points, vary| {
        let with = |point: &Vec<Assignment>, value: &String| [&point[..], &[(vary.key.clone(), value.clone())]].concat();
        points.iter().flat_map(|point| vary.values.iter().map(move |value| with(point, value))).collect()
    })
}

/// Whether a value is several numbers as other programs write a range: `0.1:0.3:3`, `0.1..0.3`.
fn is_range(value: &str) -> bool {
    let numbers = |sign: &str| value.contains(sign) && value.split(sign).all(|part| part.trim().parse::<f64>().is_ok());
    numbers(":") || numbers("..")
}

fn split(text: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quote) = (vec![String::new()], 0_i32, None);
    for sign in text.chars() {
        match (sign, quote) {
            ('"' | '\'', None) => quote = Some(sign),
            (sign, Some(open)) if sign == open => quote = None,
            ('[' | '{', None) => depth += 1,
            (']' | '}', None) => depth -= 1,
            (',', None) if depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().expect("there is always a part").push(sign);
    }
    parts.iter().map(|part| part.trim().to_owned()).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn values_are_separated_by_commas_outside_of_brackets_and_quotes() {
        let values = |text: &str| Vary::parse(text).unwrap().values;
        assert_eq!(values("a.b=1, 2,3"), ["1", "2", "3"]);
        assert_eq!(values("gravity=[0, -1],[0, -2]"), ["[0, -1]", "[0, -2]"]);
        assert_eq!(values("a={ b = [1, 2], c = 3 },\"x, y\""), ["{ b = [1, 2], c = 3 }", "\"x, y\""]);
        for text in ["a", "=1", "a=", "a=1,,2"] {
            assert!(Vary::parse(text).unwrap_err().to_string().contains("must be key=value,value"), "{text}");
        }
        for text in ["a=0.1:0.3:3", "a=1,2 : 3", "a=0.1..0.3"] {
            assert!(
                Vary::parse(text).unwrap_err().to_string().contains("there are no ranges: separate all values by commas, as a=0.1"),
                "{text}"
            );
        }
        assert_eq!(values("output.title=\"1:2\""), ["\"1:2\""]);
        assert!(Vary::parse("a=1,1").unwrap_err().to_string().contains("holds 1 twice"));
        assert!(Vary::parse_all(&["a=1".into(), "a=2".into()]).unwrap_err().to_string().contains("varied twice"));
    }

    #[test]
    fn points_are_all_combinations() {
        let all = Vary::parse_all(&["a=1,2".into(), "b=x,y,z".into()]).unwrap();
        let points = points(&all);
        assert_eq!((points.len(), points[4].clone()), (6, vec![("a".into(), "2".into()), ("b".into(), "y".into())]));
    }
}
