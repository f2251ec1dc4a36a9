//! What a run writes.

use crate::error::Result;
use crate::scene::FlowModel;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

/// Points along each axis of a lattice of probes.
const FEWEST_POINTS: u64 = 2;
const MOST_POINTS: usize = 1000;

/// What a run writes besides its summary.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputSection {
    /// Whether a picture of the flow is written.
    pub picture: bool,
    /// Time between frames, positive; absent means a hundredth of `time.end`.
    pub every: Option<f64>,
    /// Whether frames hold the flow on the grid; never in a dry scene.
    pub fields: bool,
    /// Seconds of wall time between checkpoints, not negative; 0 means one after every step.
    pub checkpoint: f64,
    /// Points along each axis of the lattice on which the flow, or the scalar, of the end is written, at least two; absent means none.
    pub probe: Option<usize>,
    /// Whether the distribution of pairs is measured.
    pub pairs: bool,
}

impl Default for OutputSection {
    fn default() -> Self {
        OutputSection { picture: true, every: None, fields: true, checkpoint: 600.0, probe: None, pairs: false }
    }
}

impl OutputSection {
    pub(in crate::scene) fn read(root: &Table, model: FlowModel) -> Result<Self> {
        let table = root.section("output", &["picture", "every", "fields", "checkpoint", "probe", "pairs"])?;
        if root.get("time").is_none() {
            refuse_frames(&table)?;
        }
        let default = OutputSection::default();
        let fields = table.get("fields").map(|entry| read_fields(&entry, model)).transpose()?;
        Ok(OutputSection {
            picture: table.get("picture").map_or(Ok(default.picture), |entry| entry.flag())?,
            every: table.get("every").map(|entry| entry.positive()).transpose()?,
            fields: fields.unwrap_or(default.fields && model != FlowModel::None),
            checkpoint: table.get("checkpoint").map_or(Ok(default.checkpoint), |entry| entry.not_negative())?,
            probe: table.get("probe").map(|entry| read_probe(&entry, model)).transpose()?,
            pairs: table.get("pairs").map_or(Ok(default.pairs), |entry| read_pairs(&entry, model))?,
        })
    }
}

fn refuse_frames(table: &Table) -> Result<()> {
    match ["every", "fields", "checkpoint"].into_iter().find_map(|name| table.get(name)) {
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

fn read_pairs(entry: &Entry, model: FlowModel) -> Result<bool> {
    let pairs = entry.flag()?;
    let remedy = "inclusions of a scalar (flow.model = \"scalar\") have no pair distribution; remove it";
    entry.expect(pairs, !pairs || model != FlowModel::Scalar, remedy)
}
