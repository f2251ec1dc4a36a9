//! Lists on the command line, `--ranks 1,2` or `--ranks 1 2`: the words of the second are joined to the first before anything else is read.

use std::ffi::{OsStr, OsString};

use clap::{Command, CommandFactory};

use super::Arguments;
use crate::scene::ConstraintMethod;

/// The words of a command line with those of each list joined by commas. A scene that follows a list is none of its words: these are numbers, or names of
/// methods.
pub fn join_lists(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let command = Arguments::command();
    let words: Vec<OsString> = words.into_iter().collect();
    let Some(own) = words.iter().skip(1).find_map(|word| command.find_subcommand(word)) else { return words };
    let end = words.iter().position(|word| word == "--").unwrap_or(words.len());
    let (mut joined, mut place) = (Vec::new(), 0);
    while place < end {
        joined.push(words[place].clone());
        let first = words.get(place + 1).filter(|_| place + 1 < end && is_list(own, &words[place]));
        place += 1;
        let Some(first) = first else { continue };
        place += 1;
        let mut list = vec![first.as_os_str()];
        while let Some(next) = words[..end].get(place).filter(|next| continues(first, next)) {
            list.push(next);
            place += 1;
        }
        joined.push(if list.len() == 1 { first.clone() } else { commas(&list) });
    }
    joined.extend_from_slice(&words[end..]);
    joined
}

/// Words with one comma between any two, whatever commas they have at their ends.
fn commas(words: &[&OsStr]) -> OsString {
    let trimmed = words.iter().map(|word| word.to_string_lossy().trim_matches(',').to_owned());
    trimmed.collect::<Vec<_>>().join(",").into()
}

/// Whether a word is a flag of a command that takes a list.
fn is_list(command: &Command, word: &OsStr) -> bool {
    let Some(name) = word.to_str().and_then(|word| word.strip_prefix("--")) else { return false };
    command.get_arguments().any(|argument| argument.get_long() == Some(name) && argument.get_value_delimiter() == Some(','))
}

/// Whether a word goes on with a list that began with another one.
fn continues(first: &OsStr, next: &OsStr) -> bool {
    let parts = |word: &OsStr| word.to_str().map(|word| word.split(',').map(str::to_owned).collect::<Vec<_>>()).unwrap_or_default();
    let all = |word: &OsStr, is: &dyn Fn(&str) -> bool| parts(word).iter().filter(|part| !part.is_empty()).all(|part| is(part));
    let number = |part: &str| part.parse::<f64>().is_ok();
    let method = |part: &str| ConstraintMethod::WORDS.contains(&part);
    let named = |word: &OsStr| !word.is_empty() && word.to_str().is_some_and(|word| !word.starts_with("--"));
    named(next) && ((all(first, &number) && all(next, &number)) || (!all(first, &number) && all(next, &method)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined(line: &str) -> String {
        let words = join_lists(line.split_whitespace().map(OsString::from));
        words.iter().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn words_of_a_list_are_joined_and_others_are_not() {
        let cases = [
            ("turbid viscosity --fractions 0.1 0.2 --strain 0", "turbid viscosity --fractions 0.1,0.2 --strain 0"),
            ("turbid viscosity --fractions 0.1, 0.2", "turbid viscosity --fractions 0.1,0.2"),
            ("turbid scaling --ranks 1 2 4 a.toml", "turbid scaling --ranks 1,2,4 a.toml"),
            ("turbid scaling --ranks 1,2 a.toml", "turbid scaling --ranks 1,2 a.toml"),
            ("turbid cost a.toml --methods sharp penalty --exact 1 -2", "turbid cost a.toml --methods sharp,penalty --exact 1,-2"),
            ("turbid cost --methods sharp scene", "turbid cost --methods sharp scene"),
            ("turbid cost a --ranks 2 3", "turbid cost a --ranks 2 3"),
            ("turbid scaling a --ranks 1 2 -- -ksp_rtol 1 2", "turbid scaling a --ranks 1,2 -- -ksp_rtol 1 2"),
            ("turbid", "turbid"),
            ("turbid cost a --resolutions", "turbid cost a --resolutions"),
        ];
        for (line, expected) in cases {
            assert_eq!(joined(line), expected, "{line}");
        }
    }
}
