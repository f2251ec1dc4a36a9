//! Films between bodies of a scene that nearly touch.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Gap, in radii, below which no film gets thinner unless the scene says otherwise.
const ROUGHNESS: f64 = 1e-4;

/// Largest roughness, in radii.
const LARGEST_ROUGHNESS: f64 = 0.1;

/// Keys of `[lubrication]`.
pub(in crate::scene) const KEYS: [Key; 2] = [
    Key::new(
        "model",
        "\"none\" or \"pairwise\"",
        "\"pairwise\"",
        "Whether the resistance of lubrication films that the multipliers do not resolve is added, \
        pair by pair, with its stress.",
    )
    .default("\"none\""),
    Key::new("roughness", "number", "1e-3", "Lubrication films resist as if no gap were smaller than this.")
        .unit("radii")
        .default("1e-4")
        .range("above 0, at most 0.1")
        .needs("lubrication.model = \"pairwise\""),
];

/// What happens between bodies that nearly touch.
#[derive(Debug, Clone, PartialEq)]
pub struct LubricationSection {
    /// The correction for films that multipliers do not see.
    pub model: LubricationModel,
}

/// The correction for films that multipliers do not see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LubricationModel {
    /// No correction.
    None,
    /// The resistance that is missing, pair by pair.
    Pairwise {
        /// Films resist as if gaps were no smaller than so many radii of the smaller body.
        roughness: f64,
    },
}

impl Default for LubricationSection {
    fn default() -> Self {
        LubricationSection { model: LubricationModel::None }
    }
}

impl LubricationSection {
    /// The roughness, if films resist.
    pub fn roughness(&self) -> Option<f64> {
        match self.model {
            LubricationModel::None => None,
            LubricationModel::Pairwise { roughness } => Some(roughness),
        }
    }

    pub(in crate::scene) fn read(root: &Table) -> Result<Self> {
        let table = root.section("lubrication", &KEYS)?;
        let pairwise = table.get("model").map_or(Ok(false), |entry| entry.choice(&[("none", false), ("pairwise", true)], &[]))?;
        let roughness = table.get("roughness").map(|entry| read_roughness(&entry, pairwise)).transpose()?;
        let model =
            if pairwise { LubricationModel::Pairwise { roughness: roughness.unwrap_or(ROUGHNESS) } } else { LubricationModel::None };
        Ok(LubricationSection { model })
    }
}

fn read_roughness(entry: &Entry, pairwise: bool) -> Result<f64> {
    let roughness = entry.positive()?;
    entry.expect((), pairwise, "has a meaning with lubrication.model = \"pairwise\" only; set that or remove it")?;
    entry.expect(roughness, roughness <= LARGEST_ROUGHNESS, &format!("must be at most {LARGEST_ROUGHNESS} radii"))
}
