//! How beads of chains are tied to each other.

use crate::body::{ChainForm, Outline, RestShape, parts};
use crate::error::Result;
use crate::scene::table::Table;

/// Beads times spacing of the shortest outline of a cell, whose beads would meet between its dimples.
const SHORTEST_OUTLINE: f64 = 24.0;

/// Most beads of a cell.
const MOST_BEADS: usize = 10_000;

/// Words of the forms that membranes without bending have.
const REST_SHAPES: [(&str, RestShape); 3] =
    [("biconcave", RestShape::Biconcave), ("ellipse", RestShape::Ellipse), ("circle", RestShape::Circle)];

/// How the beads of chains are tied to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// Beads of each chain.
    pub beads: usize,
    /// Distance of the centres of neighbours at rest, in diameters, above 1.
    pub spacing: f64,
    /// Force over the change of that distance, of cells the tension of the membrane over its strain; nothing for rods, whose length is constant.
    pub stretch: Option<f64>,
    /// Energy of bending, not negative: `bend/2 (1 - cos t)` for a turn by `t` from one bond to the next; of cells the modulus of the membrane, whose energy is
    /// `bend/2` times the integral of the square of its curvature (in space: of the sum of both), less that at rest.
    pub bend: f64,
    /// The turn from one bond to the next at rest, in radians, counterclockwise, in 3D to any side; 0 for cells, whose outline has turns of its own.
    pub angle: f64,
    /// Whether its ends are free or tied to each other.
    pub shape: ChainShape,
    /// Whether beads turn with it.
    pub joints: Joint,
    /// The outline of cells in the plane.
    pub outline: Outline,
}

impl Chain {
    /// Stiffness of bonds of this length, infinite for rods, and the energy of bending at each bead; in space those of edges and of the hinges at them.
    ///
    /// A network of equal triangles whose edges are springs `k` has Young's modulus `2 k / sqrt 3`, the shear modulus `sqrt 3 / 4 k` and the area modulus
    /// `sqrt 3 / 2 k`; hinges `c/2 t^2` at its edges have the bending modulus `sqrt 3 / 2 c` (Seung and Nelson 1988, doi:10.1103/PhysRevA.38.1005).
    pub fn stiffnesses(&self, link: f64, dimension: usize) -> (f64, f64) {
        let stretch = self.stretch.unwrap_or(f64::INFINITY);
        match (self.shape, dimension) {
            (ChainShape::Cell, 2) => (stretch / link, 2.0 * self.bend / link),
            (ChainShape::Cell, _) => (0.5 * 3f64.sqrt() * stretch, 2.0 / 3f64.sqrt() * self.bend),
            (ChainShape::Line | ChainShape::Ring, _) => (stretch, self.bend),
        }
    }
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
    pub(in crate::scene) const WORDS: [(&'static str, Joint); 2] = [("free", Joint::Free), ("fixed", Joint::Fixed)];

    /// The word for it.
    pub(in crate::scene) fn word(self) -> &'static str {
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
    pub(in crate::scene) const WORDS: [(&'static str, ChainShape); 2] = [("line", ChainShape::Line), ("ring", ChainShape::Ring)];

    /// Whether the last bead is tied to the first.
    pub fn closed(self) -> bool {
        self != ChainShape::Line
    }
}

pub(in crate::scene) fn read(table: &Table, dimension: usize) -> Result<Chain> {
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
    Ok(Chain { beads, spacing, stretch: read_stretch(table)?, bend, angle, shape, joints, outline: Outline::default() })
}

/// The membranes of cells, and the radius of their beads.
pub(in crate::scene) fn read_cells(table: &Table, dimension: usize) -> Result<(Chain, f64)> {
    let entry = table.require("beads", if dimension == 2 { "48" } else { "162" })?;
    let beads = entry.count()?;
    entry.expect((), beads <= MOST_BEADS, &format!("must be at most {MOST_BEADS}"))?;
    let (spacing, stretch, outline) = (read_spacing(table)?, read_stretch(table)?, read_outline(table, dimension)?);
    if dimension == 2 {
        let fewest = (SHORTEST_OUTLINE / spacing).ceil();
        let long_enough = outline != Outline::default() || beads as f64 >= fewest;
        entry.expect((), long_enough, &format!("must be at least {fewest}: beads of a shorter outline meet between its dimples"))?;
        let apart = outline == Outline::default() || nearest(&outline, beads) * spacing >= 1.0;
        entry.expect((), apart, "is too few: beads of opposite sides of the outline meet; take more, or a larger reduced_area")?;
    } else {
        entry.expect((), parts(beads).is_some(), "must be 42, 92, 162, 252, or another 10 n n + 2: corners of a divided icosahedron")?;
        let entry = table.require("stretch", "1.0")?;
        entry.expect((), stretch.is_some(), "leaves a membrane in space no way to bend; give a force over a length")?;
    }
    let entry = table.require("bend", "1.0")?;
    let bend = entry.positive()?;
    let chain = Chain { beads, spacing, stretch, bend, angle: 0.0, shape: ChainShape::Cell, joints: Joint::Free, outline };
    Ok((chain, read_bead_radius(table, &chain, dimension)?))
}

fn read_outline(table: &Table, dimension: usize) -> Result<Outline> {
    let rest = table.get("rest").map_or(Ok(RestShape::default()), |entry| {
        let rest = entry.choice(&REST_SHAPES, &[])?;
        entry.expect(
            rest,
            dimension == 2 || rest == RestShape::Biconcave,
            "is of outlines in two dimensions; membranes in space are biconcave",
        )
    })?;
    let any = Outline { rest, reduced_area: None };
    let entry = if rest == RestShape::Ellipse { Some(table.require("reduced_area", "0.7")?) } else { table.get("reduced_area") };
    let reduced_area = entry.map(|entry| {
        let reduced_area = entry.positive()?;
        entry.expect((), dimension == 2, "is of outlines in two dimensions; remove it")?;
        let [least, most] = any.reduced_areas();
        let remedy = format!("must lie between {least:.3} and {most:.3} for this shape");
        entry.expect(reduced_area, (least..=most + 1e-6).contains(&reduced_area), &remedy)
    });
    Ok(Outline { reduced_area: reduced_area.transpose()?, ..any })
}

/// The radius that is given, or that of beads which make a cell of the diameter that is.
fn read_bead_radius(table: &Table, chain: &Chain, dimension: usize) -> Result<f64> {
    let (name, entry) = table.exactly_one(&["diameter", "radius"], "diameter = 2.0")?;
    let given = entry.positive()?;
    if name == "radius" {
        return Ok(given);
    }
    let unit = match dimension {
        2 => ChainForm::cell(&chain.outline, 0.0, chain.beads, 1.0),
        _ => ChainForm::membrane(0.0, chain.beads, 1.0),
    };
    let farthest = unit.places.iter().map(|place| place.norm()).fold(0.0, f64::max);
    Ok(given / (4.0 * farthest * chain.spacing))
}

/// Least distance of two beads of an outline that are no neighbours, over that of neighbours.
fn nearest(outline: &Outline, beads: usize) -> f64 {
    let places = outline.places(beads, 1.0);
    let across = |one: usize| (one + 2..beads - usize::from(one == 0)).map(move |other| (one, other));
    (0..beads).flat_map(across).map(|(one, other)| (places[one] - places[other]).norm()).fold(f64::INFINITY, f64::min)
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
pub(in crate::scene) fn word(shape: ChainShape) -> &'static str {
    ChainShape::WORDS.iter().find(|(_, known)| *known == shape).map_or("", |(word, _)| word)
}

/// The word for the form of a membrane without bending.
pub(in crate::scene) fn rest_word(rest: RestShape) -> &'static str {
    REST_SHAPES.iter().find(|(_, known)| *known == rest).map_or("", |(word, _)| word)
}
