//! Keys that mean nothing where a scalar takes the place of the fluid.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::locations::join;
use crate::scene::table::Table;

const STILL: &str = "inclusions of a scalar do not move; remove it";

/// Sections and keys, and why a scalar scene has none.
const REFUSED: [(&str, &[&str], &str); 11] = [
    ("gravity", &[], "a scalar and its inclusions have no weight; remove it"),
    ("flow", &["viscosity", "density"], "a scalar (flow.model = \"scalar\") is no fluid; remove it"),
    ("method", &["inverse"], "a scalar is always solved by multigrid; remove it"),
    ("bodies", &["density", "friction", "motion", "force", "torque", "velocity", "spin"], STILL),
    ("chains", &[], STILL),
    ("cells", &[], STILL),
    ("clusters", &[], STILL),
    ("interactions", &[], STILL),
    ("contact", &[], STILL),
    ("lubrication", &[], STILL),
    ("time", &[], STILL),
];

/// Refuses the first of them that the file has.
pub(super) fn refuse_keys(root: &Table) -> Result<()> {
    for (section, keys, remedy) in REFUSED {
        let Some(entry) = root.get(section) else { continue };
        match keys {
            [] => return Err(entry.refuse(remedy)),
            _ => keys.iter().try_for_each(|key| refuse_key(&entry, key, remedy))?,
        }
    }
    match root.get("flow") {
        Some(flow) => refuse_drive(&flow),
        None => Ok(()),
    }
}

/// Refuses drives of fluids.
fn refuse_drive(flow: &Entry) -> Result<()> {
    match flow.value.as_inline_table().and_then(|table| table.get("drive")) {
        Some(value) if value.as_inline_table().is_none_or(|drive| !drive.contains_key("mean_gradient")) => {
            let remedy = "a scalar has no flow to drive; give it mean_gradient, or flow.source, a number";
            Err(Entry { value, key: join(&flow.key, "drive"), locations: flow.locations }.refuse(remedy))
        }
        _ => Ok(()),
    }
}

/// Refuses a key of a table, or of any table of a list.
fn refuse_key(entry: &Entry, key: &str, remedy: &str) -> Result<()> {
    if entry.value.is_array() {
        return entry.list()?.iter().try_for_each(|group| refuse_key(group, key, remedy));
    }
    match entry.value.as_inline_table().and_then(|table| table.get(key)) {
        Some(value) => Err(Entry { value, key: join(&entry.key, key), locations: entry.locations }.refuse(remedy)),
        None => Ok(()),
    }
}
