//! `turbid keys`: the keys of a scene file, from the tables by which it is read.

use clap::Args;

use crate::error::{Error, Result};
use crate::output::say;
use crate::scene::{Key, KeySection, SECTIONS, all_nearest};

/// What the reference of scenes begins with.
const HEAD: &str = "# Scene reference

A scene is a TOML file. This page lists every key that it may hold; it is made by `turbid keys --markdown` from the tables by which scenes are read, and
`turbid keys SECTION` or `turbid keys SECTION.KEY` prints a part of it. Units: a scene may use any consistent set of units, and the column says of which kind a
number is. Numbers are 0 or from 1e-60 to 1e60 in size. What a key needs is said by overrides without which it is refused, as one would write them after `--set`.
";

/// The words after `turbid keys`.
#[derive(Debug, Args)]
pub struct KeysArguments {
    /// A section, for example output or bodies.motion, one of its keys, for example output.every, or a word to look for in all of them (default: all).
    section: Option<String>,
    /// Print all of them as a page of Markdown.
    #[arg(long, hide = true)]
    markdown: bool,
}

/// Prints keys.
///
/// # Errors
/// [`Error::Refused`] if there is no such section.
pub fn keys(arguments: &KeysArguments) -> Result<()> {
    say(text(arguments)?.trim_end())
}

fn text(arguments: &KeysArguments) -> Result<String> {
    if arguments.markdown {
        return Ok(format!("{HEAD}{}", SECTIONS.iter().map(page).collect::<String>()));
    }
    let Some(name) = &arguments.section else {
        return Ok(SECTIONS.iter().map(|section| part(section, section.keys)).collect());
    };
    // the three axes are alike
    let name = name.trim_matches(['[', ']']).replace("domain.x", "domain.y").replace("domain.z", "domain.y");
    if let Some(section) = SECTIONS.iter().find(|section| section.name == name) {
        return Ok(part(section, section.keys));
    }
    let (table, key) = name.rsplit_once('.').unwrap_or(("top", &name));
    let section = SECTIONS.iter().find(|section| section.name == table);
    let found = section.and_then(|section| Some(part(section, &[*section.keys.iter().find(|known| known.name == key)?])));
    found.map_or_else(|| with_word(&name), Ok)
}

/// The keys that have a word in their name, then those that have it in what is said of them.
///
/// # Errors
/// No key has it.
fn with_word(word: &str) -> Result<String> {
    let sought = word.to_lowercase();
    let in_name = |key: &Key| key.name.contains(&sought);
    let in_words = |key: &Key| [key.meaning, key.kind].iter().any(|words| words.to_lowercase().contains(&sought));
    let named = all_keys().filter(|(_, key)| in_name(key)).chain(all_keys().filter(|(_, key)| !in_name(key) && in_words(key)));
    let lines: Vec<String> =
        named.map(|(section, key)| format!("  {} = {}\n      {}\n", path(section, key), key.example, key.meaning)).collect();
    match lines.is_empty() {
        true => Err(unknown(word)),
        false => Ok(format!(
            "{word}: no section of a scene and no key of one, but a word of these; turbid keys SECTION.KEY tells more\n\n{}",
            lines.concat()
        )),
    }
}

/// The refusal of a word that no key has, with the keys that may be meant.
fn unknown(word: &str) -> Error {
    let sections: Vec<&str> = SECTIONS.iter().map(|section| section.name).collect();
    let last = word.rsplit('.').next().unwrap_or(word);
    let near = all_nearest(last, all_keys().map(|(_, key)| key.name));
    let paths: Vec<String> = all_keys().filter(|(_, key)| near.contains(key.name)).map(|(section, key)| path(section, key)).collect();
    let guess = if paths.is_empty() { ";".to_owned() } else { format!("; did you mean {}?", paths.join(", ")) };
    Error::refused(format!("{word}: no section of a scene and no key of one{guess} sections: {}", sections.join(", ")))
}

/// All keys, each with its section.
fn all_keys() -> impl Iterator<Item = (&'static KeySection, &'static Key)> {
    SECTIONS.iter().flat_map(|section| section.keys.iter().map(move |key| (section, key)))
}

/// The words after `turbid keys` that show a key.
fn path(section: &KeySection, key: &Key) -> String {
    if section.name == "top" { key.name.to_owned() } else { format!("{}.{}", section.name, key.name) }
}

/// Keys of a section for a terminal.
fn part(section: &KeySection, keys: &[Key]) -> String {
    let entry = |key: &Key| {
        let words = [
            key.kind.to_owned(),
            labelled("unit: ", key.unit),
            key.range.to_owned(),
            labelled("default: ", key.default),
            labelled("needs ", key.needs),
        ];
        let facts: Vec<String> = words.into_iter().filter(|words| !words.is_empty()).collect();
        format!("  {} = {}\n      {}\n      {}\n", key.name, key.example, key.meaning, facts.join("; "))
    };
    format!("{}: {}\n\n{}\n", section.written, section.about, keys.iter().map(entry).collect::<String>())
}

fn labelled(label: &str, words: &str) -> String {
    if words.is_empty() { String::new() } else { format!("{label}{words}") }
}

/// A section of the page of Markdown.
fn page(section: &KeySection) -> String {
    let row = |key: &Key| {
        let (range, needs) = (labelled(", ", key.range), labelled(" Needs ", &code(key.needs)));
        let default = if key.default_is_a_value() { code(key.default) } else { key.default.to_owned() };
        let example = code(&format!("{} = {}", key.name, key.example));
        format!("| `{}` | {}{needs} | {}{range} | {} | {default} | {example} |\n", key.name, key.meaning, key.kind, key.unit)
    };
    let head = "| key | meaning | value | unit | default | example |\n|-|-|-|-|-|-|\n";
    let name = if section.name == "top" { "The top of the file".to_owned() } else { code(section.written) };
    format!("\n## {name}\n\n{}\n\n{head}{}", section.about, section.keys.iter().map(row).collect::<String>())
}

fn code(words: &str) -> String {
    if words.is_empty() { String::new() } else { format!("`{words}`") }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn shown(section: &str) -> Result<String> {
        text(&KeysArguments { section: Some(section.to_owned()), markdown: false })
    }

    #[test]
    fn a_section_or_a_key_is_shown_and_what_is_neither_is_refused() {
        assert!(shown("output").unwrap().contains("\n  every = 0.01\n"));
        assert_eq!(shown("[output]").unwrap(), shown("output").unwrap());
        assert_eq!(shown("domain.x").unwrap(), shown("domain.y").unwrap());
        let one = shown("output.every").unwrap();
        assert!(one.contains("every = 0.01") && !one.contains("fields"), "{one}");
        assert!(shown("seed").unwrap().contains("seed = 7"));
        for absent in ["outputs", "output.nothing", "a.b.c"] {
            let refusal = shown(absent).unwrap_err().to_string();
            assert!(refusal.starts_with(absent) && refusal.contains("sections: top, domain, "), "{refusal}");
        }
    }

    #[test]
    fn a_word_is_looked_for_in_names_and_meanings_and_a_misspelt_one_is_guessed() {
        let found = shown("viscosity").unwrap();
        assert!(found.contains("\n  flow.viscosity = ") && found.contains("\n  time.until.viscosity_interval = "), "{found}");
        assert!(shown("Hypre").unwrap().contains("\n  method.inverse = "));
        let refusal = shown("frction").unwrap_err().to_string();
        assert!(
            refusal.contains("; did you mean bodies.fraction, bodies.friction, contact.friction? sections: top, domain, "),
            "{refusal}"
        );
    }

    #[test]
    fn the_page_has_every_key_of_every_section() {
        let page = text(&KeysArguments { section: None, markdown: true }).unwrap();
        let rows = page.lines().filter(|line| line.starts_with("| `")).count();
        assert_eq!(rows, SECTIONS.iter().map(|section| section.keys.len()).sum::<usize>());
    }
}
