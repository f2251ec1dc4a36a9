//! What happens between bodies of a scene that are close.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

/// What happens between bodies that touch.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSection {
    /// The law of contact.
    pub model: ContactModel,
}

/// The law of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactModel {
    /// Bodies do not notice contact.
    None,
    /// Bodies do not overlap at the end of a step and do not bounce; there is no friction.
    Inelastic,
}

impl ContactSection {
    pub(in crate::scene) fn read(root: &Table) -> Result<Self> {
        let table = root.section("contact", &["model"])?;
        let models = [("none", ContactModel::None), ("inelastic", ContactModel::Inelastic)];
        let model = |entry: Entry| entry.choice(&models, &["repulsion", "gluey"]);
        Ok(ContactSection { model: table.get("model").map_or(Ok(ContactModel::None), model)? })
    }
}
