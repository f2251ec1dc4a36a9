//! Groups of bodies that are alike: what they are, where they start and how they move.

use std::path::{Path, PathBuf};

use toml_edit::Value;

use crate::body::{TOO_FEW, misplaced};
use crate::error::{Error, Refusal, Result};
use crate::friction::FrictionLaw;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::groups::chains::{self, Chain, ChainShape};
use crate::scene::groups::clusters::{self, Cluster};
use crate::scene::groups::keys::{BODY_KEYS, CELL_KEYS, CHAIN_KEYS, CLUSTER_KEYS, MOTION_KEYS, OSCILLATING, PATH};
use crate::scene::groups::region::Region;
use crate::scene::groups::sizes::SizeDistribution;
use crate::scene::sections::friction;
use crate::scene::table::Table;

/// Keys of `[[bodies]]` that exclude each other.
pub(in crate::scene) const PLACEMENTS: [&str; 4] = ["fraction", "count", "centers", "file"];

/// Keys of `[[chains]]` that exclude each other.
const CHAIN_PLACEMENTS: [&str; 3] = ["count", "centers", "file"];

/// Bodies that are alike: one `[[bodies]]`, one `[[chains]]`, one `[[cells]]` or one `[[clusters]]` of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyGroup {
    /// The shape of each body.
    pub shape: Shape,
    /// The radius of each body, positive.
    pub radius: f64,
    /// How radii differ from it, if they do.
    pub sizes: Option<SizeDistribution>,
    /// Where the bodies start.
    pub placement: Placement,
    /// The part of the box in which those that are placed at random lie, if it is not all of it.
    pub region: Option<Region>,
    /// How cells and clusters with given centers are turned at the start: in 2D an angle in radians, counterclockwise; in 3D a vector about which, by its
    /// length.
    pub rotation: Option<Vec<f64>>,
    /// Smallest initial gap between bodies placed at random, in radii.
    pub gap: f64,
    /// Mass per volume, not negative.
    pub density: f64,
    /// Friction of their surfaces, if it is not that of all.
    pub friction: Option<FrictionLaw>,
    /// How the bodies move.
    pub motion: Motion,
    /// External force on each body; only free bodies have one.
    pub force: Option<Vec<f64>>,
    /// External torque on each body, one number in 2D and three in 3D; only free bodies have one.
    pub torque: Option<Vec<f64>>,
    /// Initial velocity of each body; only free bodies with inertia have one.
    pub velocity: Option<Vec<f64>>,
    /// Initial turning rate, one number in 2D and three in 3D; only free bodies with inertia have one.
    pub spin: Option<Vec<f64>>,
    /// How they are tied to each other, if they are beads of chains or of cells; numbers of bodies are then those of chains, and centers those of cells.
    pub chain: Option<Chain>,
    /// Which rigid clusters they are the balls of, if they are; numbers of bodies, centers, forces and torques are then those of clusters.
    pub cluster: Option<Cluster>,
}

/// The shape of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A disk in 2D, a ball in 3D.
    Ball,
}

/// Where the bodies of a group start.
#[derive(Debug, Clone, PartialEq)]
pub enum Placement {
    /// At random, filling this part of the box, between 0 and 1.
    Fraction(f64),
    /// At random, this many, at least one.
    Count(usize),
    /// At these centers.
    Centers(Vec<Vec<f64>>),
    /// At the centers of this table (`x,y[,z][,radius]`), which nobody has opened yet.
    File(PathBuf),
}

/// How the bodies of a group move.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// As the fluid and the forces have it.
    Free,
    /// Not at all.
    Fixed,
    /// Fixed to the wall that a load presses on the bodies.
    Wall,
    /// As told.
    Prescribed {
        /// Velocity of the center.
        velocity: Vec<f64>,
        /// Turning rate: one number in 2D, three in 3D.
        spin: Vec<f64>,
    },
    /// To and fro about where the body starts: `amplitude (sin(2 pi frequency t + phase) - sin(phase))`.
    Oscillating {
        /// Of the displacement.
        amplitude: Vec<f64>,
        /// Of the angle in radians: one number in 2D, three in 3D.
        rotation: Vec<f64>,
        /// Periods over time, positive.
        frequency: f64,
        /// In radians.
        phase: f64,
    },
    /// Along the cubic spline through places, from rest to rest: each a time and the displacement from where the body starts, the first one all zeros.
    Path(Vec<Vec<f64>>),
    /// The same through the places of this table (`time,x,y[,z]`), which nobody has opened yet.
    PathFile(PathBuf),
}

pub(in crate::scene) fn read(root: &Table, folder: &Path, dimension: usize, model: FlowModel) -> Result<Vec<BodyGroup>> {
    let groups = root.get("bodies").map_or(Ok(Vec::new()), |entry| entry.list())?;
    groups.iter().map(|entry| BodyGroup::read(entry, folder, dimension, model)).collect()
}

/// The beads of all chains.
pub(in crate::scene) fn read_chains(root: &Table, folder: &Path, dimension: usize) -> Result<Vec<BodyGroup>> {
    let groups = root.get("chains").map_or(Ok(Vec::new()), |entry| entry.list())?;
    groups.iter().map(|entry| BodyGroup::read_chains(entry, folder, dimension)).collect()
}

/// The beads of all cells.
pub(in crate::scene) fn read_cells(root: &Table, folder: &Path, dimension: usize) -> Result<Vec<BodyGroup>> {
    let groups = root.get("cells").map_or(Ok(Vec::new()), |entry| entry.list())?;
    let read = |entry: &Entry| {
        let table = Table::of(entry, &CELL_KEYS)?;
        let (chain, radius) = chains::read_cells(&table, dimension)?;
        BodyGroup::tied(&table, folder, dimension, chain, radius)
    };
    groups.iter().map(read).collect()
}

/// The balls of all rigid clusters.
pub(in crate::scene) fn read_clusters(root: &Table, folder: &Path, dimension: usize) -> Result<Vec<BodyGroup>> {
    let groups = root.get("clusters").map_or(Ok(Vec::new()), |entry| entry.list())?;
    let read = |entry: &Entry| {
        let table = Table::of(entry, &CLUSTER_KEYS)?;
        let group = BodyGroup::several(&table, folder, dimension, read_radius(&table, "0.5")?)?;
        let cluster = clusters::read(&table, dimension, group.radius)?;
        Ok(BodyGroup { cluster: Some(cluster), ..group })
    };
    groups.iter().map(read).collect()
}

impl BodyGroup {
    /// Whether its bodies keep their places: they may spin there.
    pub fn stays(&self) -> bool {
        match &self.motion {
            Motion::Fixed => true,
            Motion::Prescribed { velocity, .. } => velocity.iter().all(|component| *component == 0.0),
            _ => false,
        }
    }

    /// How many things that move as one it has; two where only a table or a fraction tells.
    pub fn at_least(&self) -> usize {
        match &self.placement {
            Placement::Count(count) => *count,
            Placement::Centers(centers) => centers.len(),
            Placement::Fraction(_) | Placement::File(_) => 2,
        }
    }

    /// Balls of this radius, free and as dense as a fluid of density 1.
    pub fn new(radius: f64, placement: Placement) -> Self {
        let (shape, gap, density, motion) = (Shape::Ball, 0.05, 1.0, Motion::Free);
        let (rotation, friction, force, torque, velocity, spin) = (None, None, None, None, None, None);
        BodyGroup {
            shape,
            radius,
            sizes: None,
            placement,
            region: None,
            rotation,
            gap,
            density,
            friction,
            motion,
            force,
            torque,
            velocity,
            spin,
            chain: None,
            cluster: None,
        }
    }

    /// Whether its bodies are placed at random.
    pub fn at_random(&self) -> bool {
        matches!(self.placement, Placement::Fraction(_) | Placement::Count(_))
    }

    /// The radii of as many of its bodies, if they are placed at random.
    pub fn radii(&self, dimension: usize, count: usize) -> Vec<f64> {
        match &self.sizes {
            Some(sizes) => sizes.radii(dimension, count).into_iter().map(|size| size * self.radius).collect(),
            None => vec![self.radius; count],
        }
    }

    /// The radius of the smallest of as many of its bodies.
    pub fn smallest_of(&self, dimension: usize, count: usize) -> f64 {
        self.sizes.as_ref().map_or(1.0, |sizes| sizes.radius_of(dimension, 0, count.max(1))) * self.radius
    }

    /// The least radius that its bodies may have.
    pub fn smallest(&self) -> f64 {
        self.sizes.as_ref().map_or(1.0, |sizes| sizes.smallest()) * self.radius
    }

    /// The mean volume of its bodies over that of one of its radius.
    pub fn mean_volume(&self, dimension: usize) -> f64 {
        self.sizes.as_ref().map_or(1.0, |sizes| sizes.mean_volume(dimension))
    }

    /// The name of the list of the file that it is from.
    pub fn section(&self) -> &'static str {
        match self.chain.map(|chain| chain.shape) {
            None if self.cluster.is_some() => "clusters",
            None => "bodies",
            Some(ChainShape::Line | ChainShape::Ring) => "chains",
            Some(ChainShape::Cell) => "cells",
        }
    }

    /// The tables that it names, each with its key.
    pub fn tables(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let centers = match &self.placement {
            Placement::File(path) => Some(("file", path.as_path())),
            _ => None,
        };
        let places = match &self.motion {
            Motion::PathFile(path) => Some(("motion.path", path.as_path())),
            _ => None,
        };
        centers.into_iter().chain(places)
    }

    /// How many beads or balls each chain, cell or cluster has; nothing for bodies that are alone.
    pub fn beads(&self) -> Option<usize> {
        self.cluster.as_ref().map(Cluster::balls).or(self.chain.map(|chain| chain.beads))
    }

    /// Whether centers, numbers and forces are those of several bodies that are placed together.
    pub fn together(&self) -> bool {
        self.chain.is_some() || self.cluster.is_some()
    }

    fn read(entry: &Entry, folder: &Path, dimension: usize, model: FlowModel) -> Result<Self> {
        let table = Table::of(entry, &BODY_KEYS)?;
        let motion = table.get("motion").map_or(Ok(Motion::Free), |entry| Motion::read(&entry, folder, dimension))?;
        refuse_load(&table, &motion)?;
        refuse_start(&table, &motion, model)?;
        let placement = Placement::read(&table, folder, dimension)?;
        let shape = table.get("shape").map(|entry| read_shape(&entry)).transpose()?;
        let default = BodyGroup::new(read_radius(&table, "1.0")?, placement);
        Ok(BodyGroup {
            shape: shape.unwrap_or(default.shape),
            sizes: read_sizes(&table, &default)?,
            region: read_region(&table, &default, dimension)?,
            gap: read_gap(&table, &default)?,
            density: table.get("density").map_or(Ok(default.density), |entry| entry.not_negative())?,
            friction: table.get("friction").map(|entry| friction(&entry)).transpose()?,
            motion,
            force: table.get("force").map(|entry| entry.vector(dimension)).transpose()?,
            torque: table.get("torque").map(|entry| entry.rotation(dimension)).transpose()?,
            velocity: table.get("velocity").map(|entry| entry.vector(dimension)).transpose()?,
            spin: table.get("spin").map(|entry| entry.rotation(dimension)).transpose()?,
            ..default
        })
    }

    fn read_chains(entry: &Entry, folder: &Path, dimension: usize) -> Result<Self> {
        let table = Table::of(entry, &CHAIN_KEYS)?;
        let chain = chains::read(&table, dimension)?;
        let group = BodyGroup::tied(&table, folder, dimension, chain, read_radius(&table, "0.5")?)?;
        if let (Placement::Centers(centers), Some(given)) = (&group.placement, table.get("centers")) {
            let remedy = format!("must hold all centres of each chain, {} a chain", chain.beads);
            given.expect((), centers.len() % chain.beads == 0, &remedy)?;
        }
        Ok(group)
    }

    /// Bodies that are tied to each other so.
    fn tied(table: &Table, folder: &Path, dimension: usize, chain: Chain, radius: f64) -> Result<Self> {
        Ok(BodyGroup { chain: Some(chain), ..BodyGroup::several(table, folder, dimension, radius)? })
    }

    /// Bodies that are placed several at a time.
    fn several(table: &Table, folder: &Path, dimension: usize, radius: f64) -> Result<Self> {
        table.exactly_one(&CHAIN_PLACEMENTS, "count = 10")?;
        let placement = Placement::read(table, folder, dimension)?;
        let default = BodyGroup::new(radius, placement);
        let given = table.get("centers").or_else(|| table.get("file")).is_some();
        let rotation = |entry: Entry| {
            entry.expect((), given, "turns those whose centres are given; those placed by count lie at random; remove it")?;
            entry.rotation(dimension)
        };
        Ok(BodyGroup {
            rotation: table.get("rotation").map(rotation).transpose()?,
            region: read_region(table, &default, dimension)?,
            gap: table.get("gap").map_or(Ok(default.gap), |entry| entry.not_negative())?,
            density: table.get("density").map_or(Ok(default.density), |entry| entry.not_negative())?,
            force: table.get("force").map(|entry| entry.vector(dimension)).transpose()?,
            torque: table.get("torque").map(|entry| entry.rotation(dimension)).transpose()?,
            ..default
        })
    }
}

fn refuse_load(table: &Table, motion: &Motion) -> Result<()> {
    let load = table.get("force").or_else(|| table.get("torque"));
    match load.filter(|_| *motion != Motion::Free) {
        Some(load) => Err(load.refuse("only bodies with motion = \"free\" take an external force or torque")),
        None => Ok(()),
    }
}

fn refuse_start(table: &Table, motion: &Motion, model: FlowModel) -> Result<()> {
    let Some(start) = table.get("velocity").or_else(|| table.get("spin")) else {
        return Ok(());
    };
    let remedy = "only bodies with motion = \"free\" start with a velocity; write motion = { velocity = [..], spin = .. } for moved ones";
    start.expect((), *motion == Motion::Free, remedy)?;
    let remedy =
        "bodies in Stokes flow have no inertia: their velocity follows from forces; remove it, or write flow.model = \"navier-stokes\"";
    start.expect((), matches!(model, FlowModel::None | FlowModel::NavierStokes), remedy)
}

/// What is to be said of a missing radius where a table has the centres.
const BESIDE_FILE: &str =
    "; the table may have a column radius, whose numbers then take its place line by line, but the key is needed all the same";

fn read_radius(table: &Table, example: &str) -> Result<f64> {
    let beside_file = |missing: Error| match (missing, table.get("file")) {
        (Error::Refused(refusal), Some(_)) => Refusal { remedy: refusal.remedy.clone() + BESIDE_FILE, ..*refusal }.into(),
        (missing, _) => missing,
    };
    table.require("radius", example).map_err(beside_file)?.positive()
}

fn read_shape(entry: &Entry) -> Result<Shape> {
    let ball = entry.text()? == "ball";
    entry.expect(
        Shape::Ball,
        ball,
        "must be \"ball\", a disk or a sphere; bodies of other shapes are rigid clusters of these, [[clusters]]",
    )
}

fn read_sizes(table: &Table, default: &BodyGroup) -> Result<Option<SizeDistribution>> {
    let Some(entry) = table.get("sizes") else { return Ok(None) };
    let remedy = "only bodies placed by fraction or count differ so; remove it, or give the table of a file the column radius";
    entry.expect((), default.at_random(), remedy)?;
    SizeDistribution::read(&entry).map(Some)
}

fn read_region(table: &Table, default: &BodyGroup, dimension: usize) -> Result<Option<Region>> {
    let Some(entry) = table.get("region") else { return Ok(None) };
    entry.expect((), default.at_random(), "only bodies placed by fraction or count are placed in a region; remove it")?;
    Region::read(&entry, dimension).map(Some)
}

fn read_gap(table: &Table, default: &BodyGroup) -> Result<f64> {
    let Some(entry) = table.get("gap") else {
        return Ok(default.gap);
    };
    entry.expect((), default.at_random(), "only bodies placed by fraction or count keep a gap; remove it")?;
    entry.not_negative()
}

impl Placement {
    pub(in crate::scene) fn read(table: &Table, folder: &Path, dimension: usize) -> Result<Self> {
        let (name, entry) = table.exactly_one(&PLACEMENTS, "fraction = 0.3")?;
        Ok(match name {
            "fraction" => Placement::Fraction(read_fraction(&entry)?),
            "count" => Placement::Count(entry.count()?),
            "centers" => Placement::Centers(read_centers(&entry, dimension)?),
            _ => Placement::File(read_path(&entry, folder)?),
        })
    }
}

fn read_fraction(entry: &Entry) -> Result<f64> {
    let fraction = entry.number()?;
    entry.expect(fraction, fraction > 0.0 && fraction < 1.0, "must lie between 0 and 1")
}

fn read_centers(entry: &Entry, dimension: usize) -> Result<Vec<Vec<f64>>> {
    let centers = entry.list()?;
    entry.expect((), !centers.is_empty(), "must hold at least one centre")?;
    centers.iter().map(|center| center.vector(dimension)).collect()
}

fn read_path(entry: &Entry, folder: &Path) -> Result<PathBuf> {
    let path = entry.text()?;
    entry.expect((), !path.is_empty(), "must name a file")?;
    Ok(folder.join(path))
}

/// The places of a path: a time and a displacement each.
fn read_places(entry: &Entry, dimension: usize) -> Result<Vec<Vec<f64>>> {
    let rows = entry.list()?;
    entry.expect((), rows.len() >= 2, TOO_FEW)?;
    let mut places: Vec<Vec<f64>> = Vec::new();
    for row in &rows {
        let numbers: Vec<f64> = row.list()?.iter().map(Entry::number).collect::<Result<_>>()?;
        row.expect((), numbers.len() == dimension + 1, &format!("must be a time and {dimension} numbers, the displacement then"))?;
        misplaced(places.last().map(Vec::as_slice), &numbers).map_or(Ok(()), |remedy| Err(row.refuse(remedy)))?;
        places.push(numbers);
    }
    Ok(places)
}

impl Motion {
    fn read(entry: &Entry, folder: &Path, dimension: usize) -> Result<Self> {
        const CHOICES: &str = "\"free\", \"fixed\", \"wall\", { velocity = [..], spin = .. }, { amplitude = [..], frequency = .. }, { path = [[..], ..] } or { path = \"path.csv\" }";
        if let Ok(word) = entry.text() {
            return match word {
                "free" => Ok(Motion::Free),
                "fixed" => Ok(Motion::Fixed),
                "wall" => Ok(Motion::Wall),
                word => Err(entry.refuse(&format!("must be {CHOICES}{}", entry.guess(word, ["free", "fixed", "wall"])))),
            };
        }
        if !entry.value.is_inline_table() {
            return Err(entry.mistyped(CHOICES));
        }
        let rotations = if dimension == 2 { 1 } else { 3 };
        let still = |length| Ok(vec![0.0; length]);
        let any = Table::of(entry, &MOTION_KEYS)?;
        if let Some(path) = any.get("path") {
            Table::of(entry, &MOTION_KEYS[PATH..])?;
            return match path.value {
                Value::String(_) => read_path(&path, folder).map(Motion::PathFile),
                Value::Array(_) => read_places(&path, dimension).map(Motion::Path),
                _ => Err(path.mistyped("a list of places or the name of a table in quotes")),
            };
        }
        if any.get("amplitude").or_else(|| any.get("rotation")).is_some() {
            let table = Table::of(entry, &MOTION_KEYS[OSCILLATING..PATH])?;
            return Ok(Motion::Oscillating {
                amplitude: table.get("amplitude").map_or(still(dimension), |entry| entry.vector(dimension))?,
                rotation: table.get("rotation").map_or(still(rotations), |entry| entry.rotation(dimension))?,
                frequency: table.require("frequency", "1.0")?.positive()?,
                phase: table.get("phase").map_or(Ok(0.0), |entry| entry.number())?,
            });
        }
        let table = Table::of(entry, &MOTION_KEYS[..OSCILLATING])?;
        Ok(Motion::Prescribed {
            velocity: table.get("velocity").map_or(still(dimension), |entry| entry.vector(dimension))?,
            spin: table.get("spin").map_or(still(rotations), |entry| entry.rotation(dimension))?,
        })
    }
}
