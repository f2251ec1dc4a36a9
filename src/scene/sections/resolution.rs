//! How fine a scene with a fluid is.

use crate::error::Result;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Keys of `[resolution]` that exclude each other.
pub(in crate::scene) const SPACINGS: [&str; 2] = ["cells_per_radius", "spacing"];

/// Keys of `[resolution]`.
pub(in crate::scene) const KEYS: [Key; 3] = [
    Key::new("cells_per_radius", "number", "6", "Grid cells across the radius of the smallest body.")
        .unit("cells")
        .default("this or spacing is required")
        .range("at least 3"),
    Key::new(
        "spacing",
        "number or table",
        "0.1",
        "Edge of a grid cell, or { exactly = 0.1 }. Each axis is divided into a whole number of cells; up to \
        3 % finer or else coarser than asked for where such numbers are even and without factors above 7, which makes solvers quick.",
    )
    .unit("length")
    .default("this or cells_per_radius is required")
    .range("above 0"),
    Key::new(
        "modes",
        "\"auto\", \"most\" or a whole number",
        "8",
        "Highest order of the multipliers of each body: Fourier modes in 2D, degrees of \
        vector spherical harmonics in 3D. Automatic: about one a cell of the radius, with lubrication at most 8, and 0.6 for disks that \
        move; most: as many as the grid carries.",
    )
    .default("\"auto\"")
    .range("at least 2; of a scalar at least 1"),
];

/// Keys of `resolution.spacing`.
pub(in crate::scene) const SPACING_KEYS: [Key; 1] = [Key::new(
    "exactly",
    "number",
    "0.1",
    "Edge of a grid cell; each axis is divided into the whole number of cells that are nearest to it in length.",
)
.unit("length")
.default("required")
.range("above 0")];

/// How fine the grid and the multipliers are.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolutionSection {
    /// The grid spacing, or the length of the edges of a fitted mesh far from gaps.
    pub spacing: Spacing,
    /// The multiplier modes of each body.
    pub modes: Modes,
}

/// How the grid spacing is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spacing {
    /// Cells across the radius of the smallest body.
    CellsPerRadius(f64),
    /// A length, or one a little off it that makes solvers quick.
    Length(f64),
    /// A length, or the nearest that divides the box.
    Exactly(f64),
}

impl Spacing {
    /// The length asked for, beside a smallest body of a radius.
    pub fn length(self, smallest: f64) -> f64 {
        match self {
            Spacing::Length(length) | Spacing::Exactly(length) => length,
            Spacing::CellsPerRadius(cells) => smallest / cells,
        }
    }

    /// The key that gives it, and its number.
    pub fn key(self) -> (&'static str, f64) {
        match self {
            Spacing::Length(length) => ("resolution.spacing", length),
            Spacing::Exactly(length) => ("resolution.spacing.exactly", length),
            Spacing::CellsPerRadius(cells) => ("resolution.cells_per_radius", cells),
        }
    }

    fn read(entry: &Entry) -> Result<Self> {
        if entry.value.is_inline_table() {
            return Ok(Spacing::Exactly(Table::of(entry, &SPACING_KEYS)?.require("exactly", "0.1")?.positive()?));
        }
        Ok(Spacing::Length(entry.positive()?))
    }
}

/// How many multiplier modes each body has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Modes {
    /// About as many as there are cells per radius.
    Auto,
    /// As many as the grid carries without the multipliers seeing its noise.
    Most,
    /// This many, at least one.
    Count(usize),
}

impl ResolutionSection {
    /// A grid of this spacing, with automatic modes.
    pub fn new(spacing: Spacing) -> Self {
        ResolutionSection { spacing, modes: Modes::Auto }
    }

    pub(in crate::scene) fn read(root: &Table, model: FlowModel) -> Result<Option<Self>> {
        model.allow(root.get("resolution"))?;
        if model == FlowModel::None {
            return Ok(None);
        }
        let table = root.section("resolution", &KEYS)?;
        let (name, entry) = table.exactly_one(&SPACINGS, "cells_per_radius = 6")?;
        let spacing = match name {
            "spacing" => Spacing::read(&entry)?,
            _ => Spacing::CellsPerRadius(entry.positive()?),
        };
        let modes = table.get("modes").map_or(Ok(Modes::Auto), |entry| Modes::read(&entry))?;
        Ok(Some(ResolutionSection { spacing, modes }))
    }
}

impl Modes {
    fn read(entry: &Entry) -> Result<Self> {
        match entry.text() {
            Ok("auto") => Ok(Modes::Auto),
            Ok("most") => Ok(Modes::Most),
            Ok(_) => Err(entry.refuse("must be \"auto\", \"most\" or a whole number")),
            Err(_) => Ok(Modes::Count(entry.count()?)),
        }
    }
}
