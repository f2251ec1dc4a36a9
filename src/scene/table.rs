//! A reader for tables of a scene file that refuses unknown, missing and rival keys.

use toml_edit::{InlineTable, Value};

use crate::error::{Error, Result};
use crate::scene::elsewhere;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::locations::{Locations, join, written};
use crate::scene::nearest::nearest;

/// A table of entries; one that the file leaves out is empty.
pub(super) struct Table<'a> {
    pub(super) items: Option<&'a InlineTable>,
    pub(super) key: String,
    pub(super) locations: &'a Locations,
}

impl<'a> Table<'a> {
    pub(super) fn root(value: &'a Value, locations: &'a Locations, known: &[Key]) -> Result<Self> {
        Table::of(&Entry { value, key: String::new(), locations }, known)
    }

    /// The table of an entry, which holds nothing but known keys.
    pub(super) fn of(entry: &Entry<'a>, known: &[Key]) -> Result<Self> {
        let items = entry.value.as_inline_table().ok_or_else(|| entry.mistyped("a table"))?;
        Table { items: Some(items), key: entry.key.clone(), locations: entry.locations }.knowing(known)
    }

    pub(super) fn get(&self, name: &str) -> Option<Entry<'a>> {
        let value = self.items?.get(name)?;
        Some(Entry { value, key: join(&self.key, name), locations: self.locations })
    }

    /// The entry, or a refusal that shows how it could look.
    pub(super) fn require(&self, name: &str, example: &str) -> Result<Entry<'a>> {
        let key = join(&self.key, name);
        let path = written(&key);
        let shortest = if self.items.is_some() { name } else { &path };
        let missing = format!("missing key {path}; for example {shortest} = {example}");
        self.get(name).ok_or_else(|| self.locations.complain(&key, missing))
    }

    pub(super) fn section(&self, name: &str, known: &[Key]) -> Result<Table<'a>> {
        match self.get(name) {
            Some(entry) => Table::of(&entry, known),
            None => Ok(Table { items: None, key: join(&self.key, name), locations: self.locations }),
        }
    }

    /// The one key that is there, of several that exclude each other.
    pub(super) fn exactly_one<'n>(&self, names: &[&'n str], example: &str) -> Result<(&'n str, Entry<'a>)> {
        let choices = names.join(", ");
        let mut present = names.iter().filter_map(|&name| Some((name, self.get(name)?)));
        let Some(first) = present.next() else {
            let missing = format!("{} needs one of {choices}; for example {example}", written(&self.key));
            return Err(self.locations.complain(&self.key, missing));
        };
        match present.next() {
            Some((_, second)) => Err(second.refuse(&format!("excludes {}; keep one of {choices}", first.0))),
            None => Ok(first),
        }
    }

    fn knowing(self, known: &[Key]) -> Result<Self> {
        let known: Vec<&str> = known.iter().map(|key| key.name).collect();
        let mut names = self.items.into_iter().flat_map(InlineTable::iter).map(|(name, _)| name);
        match names.find(|name| !known.contains(name)) {
            Some(stranger) => Err(self.unknown(stranger, &known)),
            None => Ok(self),
        }
    }

    fn unknown(&self, name: &str, known: &[&str]) -> Error {
        let key = join(&self.key, name);
        let guess = match nearest(name, known.iter().copied()) {
            Some(known) => format!("; did you mean {known}?"),
            None => elsewhere::answer(name).map_or(";".to_owned(), |answer| format!("; {answer};")),
        };
        let message = format!("unknown key {}{guess} known keys: {}", written(&key), known.join(", "));
        self.locations.complain(&key, message)
    }
}
