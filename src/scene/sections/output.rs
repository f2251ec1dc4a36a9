//! What a run writes.

use crate::error::Result;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

/// Points along each axis of a lattice of probes.
const FEWEST_POINTS: u64 = 2;
const MOST_POINTS: usize = 1000;

const KEYS: [&str; 10] =
    ["picture", "colour", "every", "fields", "vorticity", "checkpoint", "probe", "pairs", "profiles", "reference_velocity"];

/// Most bodies whose motion is given for the forces on them to have a table.
pub const MOST_WITH_FORCES: usize = 16;

/// What a run writes besides its summary.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputSection {
    /// Whether a picture of the flow is written.
    pub picture: bool,
    /// What colours the flow in the picture and in an animation.
    pub colour: Colour,
    /// Time between frames, positive; absent means a hundredth of `time.end`.
    pub every: Option<f64>,
    /// Whether frames hold the flow on the grid; never in a dry scene.
    pub fields: bool,
    /// Whether frames that hold the flow hold its vorticity too, also where nothing is coloured by it.
    pub vorticity: bool,
    /// Seconds of wall time between checkpoints, not negative; 0 means one after every step.
    pub checkpoint: f64,
    /// Points along each axis of the lattice on which the flow, or the scalar, of the end is written, at least two; absent means none.
    pub probe: Option<usize>,
    /// Whether the distribution of pairs is measured.
    pub pairs: bool,
    /// Axes across which profiles are measured, each once.
    pub profiles: Vec<usize>,
    /// Velocity of the stream to which forces on bodies whose motion is given are referred, not zero; absent means no coefficients of drag and lift.
    pub reference_velocity: Option<Vec<f64>>,
}

/// What colours a flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// The speed.
    Speed,
    /// The vorticity in the plane that is shown, counterclockwise positive.
    Vorticity,
    /// The speed of the fluid, and bodies by the chain, cell or cluster that they belong to.
    Chain,
}

impl Default for OutputSection {
    fn default() -> Self {
        OutputSection {
            picture: true,
            colour: Colour::Speed,
            every: None,
            fields: true,
            vorticity: false,
            checkpoint: 600.0,
            probe: None,
            pairs: false,
            profiles: Vec::new(),
            reference_velocity: None,
        }
    }
}

impl OutputSection {
    /// Whether frames hold the vorticity.
    pub fn stores_vorticity(&self) -> bool {
        self.fields && (self.vorticity || self.colour == Colour::Vorticity)
    }

    pub(in crate::scene) fn read(root: &Table, dimension: usize, model: FlowModel) -> Result<Self> {
        let table = root.section("output", &KEYS)?;
        if root.get("time").is_none() {
            refuse_frames(&table)?;
        }
        let default = OutputSection::default();
        let fields = table.get("fields").map(|entry| read_fields(&entry, model)).transpose()?;
        Ok(OutputSection {
            picture: table.get("picture").map_or(Ok(default.picture), |entry| entry.flag())?,
            colour: table.get("colour").map_or(Ok(default.colour), |entry| read_colour(&entry, model))?,
            every: table.get("every").map(|entry| entry.positive()).transpose()?,
            fields: fields.unwrap_or(default.fields && model != FlowModel::None),
            vorticity: table.get("vorticity").map_or(Ok(default.vorticity), |entry| read_vorticity(&entry, model))?,
            checkpoint: table.get("checkpoint").map_or(Ok(default.checkpoint), |entry| entry.not_negative())?,
            probe: table.get("probe").map(|entry| read_probe(&entry, model)).transpose()?,
            pairs: table.get("pairs").map_or(Ok(default.pairs), |entry| read_pairs(&entry, model))?,
            profiles: table.get("profiles").map_or(Ok(Vec::new()), |entry| read_profiles(&entry, dimension, model))?,
            reference_velocity: table.get("reference_velocity").map(|entry| read_reference(&entry, dimension)).transpose()?,
        })
    }
}

fn refuse_frames(table: &Table) -> Result<()> {
    match ["every", "fields", "vorticity", "checkpoint"].into_iter().find_map(|name| table.get(name)) {
        Some(entry) => Err(entry.refuse("an instantaneous solve writes no frames and no checkpoints; add [time] or remove it")),
        None => Ok(()),
    }
}

fn read_probe(entry: &Entry, model: FlowModel) -> Result<usize> {
    let points = entry.whole(FEWEST_POINTS)? as usize;
    let remedy = "a dry scene (flow.model = \"none\") has no flow to write; remove it";
    entry.expect(points, model != FlowModel::None, remedy)?;
    entry.expect(points, points <= MOST_POINTS, &format!("must be at most {MOST_POINTS}"))
}

fn read_fields(entry: &Entry, model: FlowModel) -> Result<bool> {
    let fields = entry.flag()?;
    let remedy = "a dry scene (flow.model = \"none\") has no flow to write; remove it";
    entry.expect(fields, !fields || model != FlowModel::None, remedy)
}

impl Colour {
    /// Their words.
    pub(in crate::scene) const WORDS: [(&str, Colour); 3] =
        [("speed", Colour::Speed), ("vorticity", Colour::Vorticity), ("chain", Colour::Chain)];
}

fn read_colour(entry: &Entry, model: FlowModel) -> Result<Colour> {
    let colour = entry.choice(&Colour::WORDS, &[])?;
    entry.expect(colour, model.fluid() || colour == Colour::Chain, "only a flow is coloured so; remove it")
}

fn read_vorticity(entry: &Entry, model: FlowModel) -> Result<bool> {
    let vorticity = entry.flag()?;
    entry.expect(vorticity, !vorticity || model.fluid(), "only a flow has vorticity; remove it")
}

fn read_reference(entry: &Entry, dimension: usize) -> Result<Vec<f64>> {
    let velocity = entry.vector(dimension)?;
    let moves = velocity.iter().any(|&component| component != 0.0);
    entry.expect(velocity, moves, "must not be 0: drag is the force along it")
}

fn read_profiles(entry: &Entry, dimension: usize, model: FlowModel) -> Result<Vec<usize>> {
    let words = &[("x", 0), ("y", 1), ("z", 2)][..dimension];
    let axes = match entry.value.as_array() {
        Some(_) => entry.list()?.iter().map(|axis| axis.choice(words, &[])).collect::<Result<Vec<_>>>()?,
        None => vec![entry.choice(words, &[])?],
    };
    let once = (1..axes.len()).all(|place| !axes[..place].contains(&axes[place]));
    let axes = entry.expect(axes, once, "names an axis twice")?;
    let axes = entry.expect(axes.clone(), !axes.is_empty(), "must be an axis, as \"y\", or a list of axes")?;
    let remedy = "inclusions of a scalar (flow.model = \"scalar\") have no profiles; remove it";
    entry.expect(axes, model != FlowModel::Scalar, remedy)
}

fn read_pairs(entry: &Entry, model: FlowModel) -> Result<bool> {
    let pairs = entry.flag()?;
    let remedy = "inclusions of a scalar (flow.model = \"scalar\") have no pair distribution; remove it";
    entry.expect(pairs, !pairs || model != FlowModel::Scalar, remedy)
}
