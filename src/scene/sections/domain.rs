//! The box of a scene.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;

/// Keys of `[domain]`.
pub(in crate::scene) const KEYS: [Key; 6] = [
    Key::new(
        "size",
        "list of 2 or 3 numbers",
        "[8.0, 8.0]",
        "Edge lengths of the box; two make the scene two-dimensional, three \
        three-dimensional. The box starts at the origin.",
    )
    .unit("length")
    .default("required")
    .range("each above 0"),
    Key::new("x", AXIS, "{ inflow = 1.0 }", "What bounds the first axis.").default("\"periodic\""),
    Key::new("y", AXIS, "{ lower = [-1.0, 0.0], upper = [1.0, 0.0] }", "What bounds the second axis.").default("\"periodic\""),
    Key::new("z", AXIS, "\"walls\"", "What bounds the third axis.").default("\"periodic\"").needs("domain.size = [8.0, 8.0, 8.0]"),
    Key::new(
        "normal_stress",
        "number",
        "2.0",
        "Pressure on the upper wall across the one axis that has walls, which moves along its normal under it and the dry bodies below, from its place at \
        the end of the box.",
    )
    .unit("pressure")
    .range("above 0")
    .needs(PRESSED),
    Key::new("wall_mass", "number", "3.0", "Mass per area of that wall.")
        .unit("mass/area")
        .default("that of a layer of the free bodies: their mass over the sum of their diameters, in 3D of the squares of these")
        .range("above 0")
        .needs("domain.normal_stress = 2.0; domain.y = \"walls\"; flow.model = \"none\"; contact.model = \"inelastic\"; time.end = 1.0"),
];

const PRESSED: &str = "domain.y = \"walls\"; flow.model = \"none\"; contact.model = \"inelastic\"; time.end = 1.0";

const AXIS: &str = "\"periodic\", \"walls\" (at rest) or a table";

/// Keys of an axis of `[domain]`: two walls, or an inflow and an outflow.
pub(in crate::scene) const AXIS_KEYS: [Key; 4] = [
    Key::new("lower", "list of numbers", "[-1.0, 0.0]", "Velocity of the wall at coordinate 0.")
        .unit("length/time")
        .default("required with upper")
        .range("0 along the axis itself")
        .needs("domain.y.upper = [1.0, 0.0]"),
    Key::new("upper", "list of numbers", "[1.0, 0.0]", "Velocity of the wall at the other end.")
        .unit("length/time")
        .default("required with lower")
        .range("0 along the axis itself")
        .needs("domain.y.lower = [-1.0, 0.0]"),
    Key::new("inflow", "number", "1.0", "Largest velocity of the fluid that enters at coordinate 0 and leaves at the other end.")
        .unit("length/time")
        .range("above 0")
        .needs("domain.y = { inflow = 1.0 }; domain.x = \"walls\""),
    Key::new(
        "profile",
        "\"parabolic\" or \"uniform\"",
        "\"uniform\"",
        "How the inflow is distributed: parabolic, 0 at walls of other axes, or \
        uniform.",
    )
    .default("\"parabolic\"")
    .needs("domain.y = { inflow = 1.0 }; domain.x = \"walls\""),
];

const WALLS: usize = 2;

/// The box: its size and what bounds it.
#[derive(Debug, Clone, PartialEq)]
pub struct DomainSection {
    /// Edge lengths; their number is the dimension.
    pub size: Vec<f64>,
    /// What bounds each axis.
    pub axes: Vec<AxisSection>,
    /// What presses the upper wall across the axis that has walls, if anything does.
    pub load: Option<NormalLoad>,
}

/// A pressure that moves a wall along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalLoad {
    /// The pressure, positive.
    pub stress: f64,
    /// Mass of the wall per area, positive, if it is not that of a layer of the free bodies.
    pub wall_mass: Option<f64>,
}

/// What bounds the box along one axis.
#[derive(Debug, Clone, PartialEq)]
pub enum AxisSection {
    /// The box repeats.
    Periodic,
    /// Two walls that move along themselves: the component along the axis is zero.
    Walls {
        /// Velocity of the wall at coordinate 0.
        lower: Vec<f64>,
        /// Velocity of the wall at coordinate `size`.
        upper: Vec<f64>,
    },
    /// Fluid flows in at coordinate 0 and out at coordinate `size`.
    Open {
        /// Its largest velocity, positive.
        inflow: f64,
        /// Whether it falls to zero at walls of other axes as a parabola; else it is uniform.
        parabolic: bool,
    },
}

impl DomainSection {
    pub(in crate::scene) fn read(root: &Table) -> Result<Self> {
        let table = root.section("domain", &KEYS)?;
        let size = read_size(&table.require("size", "[8.0, 4.0]")?)?;
        let dimension = size.len();
        if let Some(z) = table.get("z").filter(|_| dimension == 2) {
            return Err(z.refuse("a box with two numbers in domain.size has no z axis"));
        }
        let axis = |(index, name)| match table.get(name) {
            Some(entry) => AxisSection::read(&entry, index, dimension),
            None => Ok(AxisSection::Periodic),
        };
        let axes = ["x", "y", "z"].into_iter().take(dimension).enumerate().map(axis).collect::<Result<_>>()?;
        Ok(DomainSection { size, axes, load: NormalLoad::read(&table)? })
    }

    /// The axis whose upper wall a load presses.
    pub fn loaded_axis(&self) -> Option<usize> {
        self.load.and_then(|_| self.axes.iter().position(|axis| matches!(axis, AxisSection::Walls { .. })))
    }
}

impl NormalLoad {
    fn read(table: &Table) -> Result<Option<Self>> {
        let wall_mass = table.get("wall_mass");
        let Some(stress) = table.get("normal_stress") else {
            let remedy = "is that of a wall that domain.normal_stress presses; give that, or remove it";
            return wall_mass.map_or(Ok(None), |mass| Err(mass.refuse(remedy)));
        };
        Ok(Some(NormalLoad { stress: stress.positive()?, wall_mass: wall_mass.map(|mass| mass.positive()).transpose()? }))
    }
}

/// Words of the profiles of an inflow, and whether they are parabolic.
pub(in crate::scene) const PROFILES: [(&str, bool); 2] = [("parabolic", true), ("uniform", false)];

impl AxisSection {
    fn read(entry: &Entry, axis: usize, dimension: usize) -> Result<Self> {
        const CHOICES: &str = "\"periodic\", \"walls\", { lower = [..], upper = [..] } or { inflow = .. }";
        if let Ok(word) = entry.text() {
            return match word {
                "periodic" => Ok(AxisSection::Periodic),
                "walls" => Ok(AxisSection::Walls { lower: vec![0.0; dimension], upper: vec![0.0; dimension] }),
                word => Err(entry.refuse(&format!("must be {CHOICES}{}", entry.guess(word, ["periodic", "walls"])))),
            };
        }
        if !entry.value.is_inline_table() {
            return Err(entry.mistyped(CHOICES));
        }
        let any = Table::of(entry, &AXIS_KEYS)?;
        if let Some(inflow) = any.get("inflow") {
            let table = Table::of(entry, &AXIS_KEYS[WALLS..])?;
            let profile = |entry: Entry| entry.choice(&PROFILES, &[]);
            return Ok(AxisSection::Open { inflow: inflow.positive()?, parabolic: table.get("profile").map_or(Ok(true), profile)? });
        }
        let table = Table::of(entry, &AXIS_KEYS[..WALLS])?;
        let wall = |name| read_wall(&table.require(name, &format!("{:?}", vec![0.0; dimension]))?, axis, dimension);
        Ok(AxisSection::Walls { lower: wall("lower")?, upper: wall("upper")? })
    }
}

fn read_size(entry: &Entry) -> Result<Vec<f64>> {
    let lengths = entry.list()?;
    let remedy = "must be a list of two numbers (2D) or three (3D)";
    entry.expect((), matches!(lengths.len(), 2 | 3), remedy)?;
    lengths.iter().map(Entry::positive).collect()
}

fn read_wall(entry: &Entry, axis: usize, dimension: usize) -> Result<Vec<f64>> {
    let velocity = entry.vector(dimension)?;
    let still = velocity[axis] == 0.0;
    let remedy = format!("number {} must be 0: a wall cannot move along its own axis", axis + 1);
    entry.expect(velocity, still, &remedy)
}
