//! A key of a scene file with all that is to be known of it: what readers accept and what the reference of scenes says come from the same tables.

/// A key of one table of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Key {
    /// Its name in its table.
    pub name: &'static str,
    /// The type of its value, or the words that it takes.
    pub kind: &'static str,
    /// The unit of the value; empty if it has none.
    pub unit: &'static str,
    /// The value that holds where the file gives none: as the file would write it, or in words.
    pub default: &'static str,
    /// What values are allowed beyond their type; empty if all are.
    pub range: &'static str,
    /// A value as a file writes it.
    pub example: &'static str,
    /// Overrides, with `; ` between them, without which the key means nothing; empty if it always means something.
    pub needs: &'static str,
    /// What it says.
    pub meaning: &'static str,
}

impl Key {
    /// A key that takes its example as it is, without unit or bounds, and may be left out.
    pub(in crate::scene) const fn new(name: &'static str, kind: &'static str, example: &'static str, meaning: &'static str) -> Key {
        Key { name, kind, unit: "", default: "none", range: "", example, needs: "", meaning }
    }

    /// Whether the default is a value that a file could give, not a sentence.
    pub fn default_is_a_value(&self) -> bool {
        self.default.parse::<toml_edit::Value>().is_ok()
    }

    pub(in crate::scene) const fn unit(self, unit: &'static str) -> Key {
        Key { unit, ..self }
    }

    pub(in crate::scene) const fn default(self, default: &'static str) -> Key {
        Key { default, ..self }
    }

    pub(in crate::scene) const fn range(self, range: &'static str) -> Key {
        Key { range, ..self }
    }

    pub(in crate::scene) const fn needs(self, needs: &'static str) -> Key {
        Key { needs, ..self }
    }
}
