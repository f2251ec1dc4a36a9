//! How beads of chains are tied to each other.

use crate::body::parts;
use crate::error::Result;
use crate::scene::table::Table;

/// Beads times spacing of the shortest outline of a cell, whose beads would meet between its dimples.
const SHORTEST_OUTLINE: f64 = 24.0;

/// How the beads of chains are tied to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// Beads of each chain.
    pub beads: usize,
    /// Distance of the centres of neighbours at rest, in diameters, above 1.
    pub spacing: f64,
    /// Force over the change of that distance; nothing for rods, whose length is constant.
    pub stretch: Option<f64>,
    /// Energy of bending, not negative: `bend/2 (1 - cos t)` for a turn by `t` from one bond to the next.
    pub bend: f64,
    /// The turn from one bond to the next at rest, in radians, counterclockwise, in 3D to any side; 0 for cells, whose outline has turns of its own.
    pub angle: f64,
    /// Whether its ends are free or tied to each other.
    pub shape: ChainShape,
    /// Whether beads turn with it.
    pub joints: Joint,
}

/// How a bead sits in its chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// It turns about its centre on its own.
    Free,
    /// It turns as the line through its neighbours does.
    Fixed,
}

impl Joint {
    pub(super) const WORDS: [(&'static str, Joint); 2] = [("free", Joint::Free), ("fixed", Joint::Fixed)];

    /// The word for it.
    pub(super) fn word(self) -> &'static str {
        Joint::WORDS.iter().find(|(_, known)| *known == self).map_or("", |(word, _)| word)
    }
}

/// The shape of a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChainShape {
    /// Two free ends.
    Line,
    /// None.
    Ring,
    /// None: the membrane of a red cell, which keeps its area.
    Cell,
}

impl ChainShape {
    /// Words of the shapes that chains may have.
    pub(super) const WORDS: [(&'static str, ChainShape); 2] = [("line", ChainShape::Line), ("ring", ChainShape::Ring)];

    /// Whether the last bead is tied to the first.
    pub fn closed(self) -> bool {
        self != ChainShape::Line
    }
}

pub(super) fn read(table: &Table, dimension: usize) -> Result<Chain> {
    let shape = table.get("shape").map_or(Ok(ChainShape::Line), |entry| entry.choice(&ChainShape::WORDS, &[]))?;
    let (entry, least) = (table.require("beads", "10")?, if shape == ChainShape::Ring { 3 } else { 2 });
    let beads = entry.count()?;
    entry.expect((), beads >= least, &format!("must be at least {least} in a {}", word(shape)))?;
    let spacing = read_spacing(table)?;
    let bend = table.get("bend").map_or(Ok(0.0), |entry| entry.not_negative())?;
    let natural = if shape == ChainShape::Ring { std::f64::consts::TAU / beads as f64 } else { 0.0 };
    let angle = table.get("angle").map_or(Ok(natural), |entry| {
        let angle = entry.number()?;
        entry.expect((), dimension == 2 || angle >= 0.0, "must not be negative: in three dimensions a bond has no side to turn to")?;
        entry.expect((), bend > 0.0, "is what bend draws chains to; give bend")?;
        entry.expect(angle, angle.abs() < std::f64::consts::PI, "must lie between -pi and pi")
    })?;
    let joints = table.get("joints").map_or(Ok(Joint::Free), |entry| {
        let joints = entry.choice(&Joint::WORDS, &[])?;
        let twists = dimension == 3 && shape == ChainShape::Ring && joints == Joint::Fixed;
        entry.expect(joints, !twists, "lets no ring in space bend out of its plane; set \"free\"")
    })?;
    Ok(Chain { beads, spacing, stretch: read_stretch(table)?, bend, angle, shape, joints })
}

/// The membranes of cells.
pub(super) fn read_cells(table: &Table, dimension: usize) -> Result<Chain> {
    let entry = table.require("beads", if dimension == 2 { "24" } else { "162" })?;
    let beads = entry.count()?;
    let (spacing, stretch) = (read_spacing(table)?, read_stretch(table)?);
    if dimension == 2 {
        let fewest = (SHORTEST_OUTLINE / spacing).ceil();
        entry.expect(
            (),
            beads as f64 >= fewest,
            &format!("must be at least {fewest}: beads of a shorter outline meet between its dimples"),
        )?;
    } else {
        entry.expect((), parts(beads).is_some(), "must be 42, 92, 162, 252, or another 10 n n + 2: corners of a divided icosahedron")?;
        let entry = table.require("stretch", "1.0")?;
        entry.expect((), stretch.is_some(), "leaves a membrane in space no way to bend; give a force over a length")?;
    }
    let entry = table.require("bend", "1.0")?;
    let bend = entry.positive()?;
    Ok(Chain { beads, spacing, stretch, bend, angle: 0.0, shape: ChainShape::Cell, joints: Joint::Free })
}

fn read_spacing(table: &Table) -> Result<f64> {
    table.get("spacing").map_or(Ok(1.05), |entry| {
        let spacing = entry.positive()?;
        entry.expect(spacing, spacing > 1.0, "is in diameters of a bead; at 1 and below beads overlap")
    })
}

fn read_stretch(table: &Table) -> Result<Option<f64>> {
    let entry = table.require("stretch", "\"rigid\"")?;
    match entry.text() {
        Ok("rigid") => Ok(None),
        Ok(_) => Err(entry.refuse("must be \"rigid\" or a force over a length")),
        Err(_) => entry.positive().map(Some),
    }
}

/// The word for a shape.
pub(super) fn word(shape: ChainShape) -> &'static str {
    ChainShape::WORDS.iter().find(|(_, known)| *known == shape).map_or("", |(word, _)| word)
}
