//! Where each key of a scene was written, so that every refusal can say it.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::ops::Range;

use toml_edit::{Array, Document, Item, Key, TableLike, Value};

use crate::error::{Error, Place, Refusal};

/// The place of every key of a scene: a line of its file, an override, or nothing if the scene was never written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Locations {
    /// Name of the file, if there is one.
    file: Option<String>,
    /// Lines of keys; nothing for those of overrides.
    lines: BTreeMap<String, Option<usize>>,
}

impl Locations {
    pub(super) fn of(file: &str, document: &Document<&str>) -> Self {
        let mut walk = Walk { lines: Lines::of(document.raw()), places: BTreeMap::new() };
        walk.table("", document.as_table());
        Locations { file: Some(file.to_owned()), lines: walk.places }
    }

    /// The refusal of a key's value.
    pub(super) fn refuse(&self, key: &str, value: impl Display, remedy: &str) -> Error {
        Refusal { value: Some(value.to_string()), ..self.refusal(key, remedy.to_owned()) }.into()
    }

    /// The refusal of a key that the message names.
    pub(super) fn complain(&self, key: &str, message: String) -> Error {
        self.refusal(key, message).into()
    }

    fn refusal(&self, key: &str, remedy: String) -> Refusal {
        let key = dotted(key);
        let place = match self.nearest(&key) {
            Some(line) => self.file.as_ref().map(|file| Place::Line { file: file.clone(), line }),
            None => Some(Place::Override(None)),
        };
        Refusal { place, key: Some(written(&key)), remedy, ..Refusal::default() }
    }

    /// A refusal that begins with a key, with the place of that key; any other error as it is.
    pub(super) fn place(&self, error: Error, sections: &[&str]) -> Error {
        let Error::Refused(refusal) = &error else { return error };
        let Refusal { place: None, key: None, remedy, .. } = refusal.as_ref() else { return error };
        let key = remedy.split([' ', ':', '=', ',']).next().unwrap_or_default();
        match sections.contains(&key.split(['.', '[']).next().unwrap_or_default()) {
            true => self.complain(key, remedy.clone()),
            false => error,
        }
    }

    pub(super) fn forget(&mut self, key: &str) {
        let inside = format!("{key}.");
        self.lines.retain(|path, _| path != key && !path.starts_with(&inside));
    }

    pub(super) fn overridden(&mut self, key: &str) {
        self.forget(key);
        self.lines.insert(key.to_owned(), None);
    }

    /// The line of a key or of the innermost table around it that was written; nothing if that was an override.
    fn nearest(&self, key: &str) -> Option<usize> {
        let ends = key.rmatch_indices('.').map(|(end, _)| end);
        std::iter::once(key.len()).chain(ends).find_map(|end| self.lines.get(&key[..end]).copied()).unwrap_or(Some(1))
    }
}

/// `bodies.0.radius`, however it was written.
pub(super) fn dotted(key: &str) -> String {
    key.replace('[', ".").replace(']', "")
}

/// `bodies[0].radius`, as messages write it.
pub(super) fn written(dotted: &str) -> String {
    let mut text = String::new();
    for part in dotted.split('.') {
        if !text.is_empty() && part.parse::<usize>().is_ok() {
            text += &format!("[{part}]");
        } else {
            let dot = if text.is_empty() { "" } else { "." };
            text += &format!("{dot}{}", part.escape_debug());
        }
    }
    text
}

/// The path of `name` inside the table at `path`.
pub(super) fn join(path: &str, name: impl Display) -> String {
    if path.is_empty() { name.to_string() } else { format!("{path}.{name}") }
}

/// Line numbers of positions in a text.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        Lines(text.match_indices('\n').map(|(position, _)| position).collect())
    }

    pub(super) fn at(&self, span: &Range<usize>) -> usize {
        1 + self.0.partition_point(|&end| end < span.start)
    }
}

struct Walk {
    lines: Lines,
    places: BTreeMap<String, Option<usize>>,
}

impl Walk {
    fn table(&mut self, path: &str, table: &dyn TableLike) {
        for (name, item) in table.iter() {
            let path = join(path, name);
            self.note(&path, table.key(name).and_then(Key::span));
            self.item(&path, item);
        }
    }

    fn item(&mut self, path: &str, item: &Item) {
        match item {
            Item::None => {}
            Item::Value(value) => self.value(path, value),
            Item::Table(table) => self.table(path, table),
            Item::ArrayOfTables(tables) => {
                for (index, table) in tables.iter().enumerate() {
                    let path = join(path, index);
                    self.note(&path, table.span());
                    self.table(&path, table);
                }
            }
        }
    }

    fn value(&mut self, path: &str, value: &Value) {
        match value {
            Value::InlineTable(table) => self.table(path, table),
            Value::Array(array) => self.array(path, array),
            _ => {}
        }
    }

    fn array(&mut self, path: &str, array: &Array) {
        for (index, value) in array.iter().enumerate() {
            let path = join(path, index);
            self.note(&path, value.span());
            self.value(&path, value);
        }
    }

    fn note(&mut self, path: &str, span: Option<Range<usize>>) {
        if let Some(span) = span {
            let line = self.lines.at(&span);
            self.places.insert(path.to_owned(), Some(line));
        }
    }
}
