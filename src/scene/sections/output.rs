//! What a run writes.

use crate::error::Result;
use crate::geometry::Protocol;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::table::Table;
use crate::scene::{Drive, FlowModel, FlowSection};

/// Points along each axis of a lattice of probes.
const FEWEST_POINTS: u64 = 2;
const MOST_POINTS: usize = 1000;

/// Keys of `[output]`.
pub(in crate::scene) const KEYS: [Key; 19] = [
    Key::new("picture", "true or false", "false", "Whether a picture of the end is drawn.").default("true"),
    Key::new("report", "true or false", "false", "Whether a page of the run, report.html, is written and renewed while it runs.")
        .default("true"),
    Key::new("plane", "\"xy\", \"xz\" or \"yz\"", "\"xz\"", "The axes that point right and up in pictures of a scene in three dimensions.")
        .default("the plane that shows gravity, or else the shear")
        .needs("domain.size = [8.0, 8.0, 8.0]"),
    Key::new("plane_at", "number", "2.0", "Where that plane cuts the axis across it.")
        .unit("length")
        .default("the middle of the box")
        .needs("domain.size = [8.0, 8.0, 8.0]"),
    Key::new(
        "colour",
        "\"speed\", \"nonaffine\", \"vorticity\", \"chain\" or \"species\"",
        "\"vorticity\"",
        "What colours the picture and animations: the speed, the speed relative to the shear (nonaffine), the \
        vorticity of the fluid (bodies dark), or bodies by the chain, cell or cluster that they belong to, or by their radius (species).",
    )
    .default("\"speed\"; with shear_rate \"nonaffine\""),
    Key::new("every", "number", "0.01", "Time between frames.")
        .unit("time")
        .default("a hundredth of time.end")
        .range("above 0")
        .needs("time.end = 1.0"),
    Key::new(
        "fields",
        "true or false",
        "true",
        "Whether frames hold the flow on the grid: velocity, pressure and what is inside of bodies. An instantaneous solve writes a frame only with it.",
    )
    .default("true in time, false at an instant"),
    Key::new("vorticity", "true or false", "true", "Whether frames that hold the flow hold its vorticity too.").default("false"),
    Key::new(
        "vtkhdf",
        "true or false",
        "false",
        "Whether frames are also shown as VTKHDF, in bodies.vtkhdf and fields.vtkhdf for ParaView's own reader, once the run has ended.",
    )
    .default("true"),
    Key::new(
        "objects",
        "true or false",
        "false",
        "Whether chains.csv, cells.csv and clusters.csv are written: a row of each chain, cell and rigid cluster at the time of every frame, and when one \
        has turned by a quarter since its last row.",
    )
    .default("true where there are such objects")
    .needs("time.end = 1.0"),
    Key::new("checkpoint", "number", "60", "Seconds of wall time between checkpoints; 0 writes one after every step.")
        .unit("seconds")
        .default("600")
        .range("at least 0")
        .needs("time.end = 1.0"),
    Key::new(
        "probe",
        "whole number",
        "32",
        "Points along each axis of a lattice on which the flow, or the scalar, of the end is written to \
        probe.csv.",
    )
    .range("2 to 1000"),
    Key::new(
        "pairs",
        "true or false",
        "true",
        "Whether the pair distribution, its direction at contact and the coordination number are \
        measured.",
    )
    .default("false"),
    Key::new("structure_factor", "true or false", "true", "Whether the structure factor of the places of bodies is measured, along periodic axes.")
        .default("false"),
    Key::new(
        "displacements",
        "true or false",
        "true",
        "Whether mean-square displacements of the free bodies are measured, less their mean and what the shear of a fluid carries along, and the diffusivities that \
        follow. Of dry bodies between walls that move the shear is not subtracted: along these walls displacements show the velocity profile, not diffusion.",
    )
    .default("false")
    .needs("time.end = 1.0"),
    Key::new(
        "velocity_autocorrelation",
        "true or false",
        "true",
        "Whether the autocorrelation of the velocities of the free bodies is measured, less those of the shear and their mean.",
    )
    .default("false")
    .needs("time.end = 1.0"),
    Key::new(
        "profiles",
        "\"x\", \"y\", \"z\", or a list of them",
        "\"y\"",
        "Axes across which profiles are measured: velocity, solid fraction and stress, \
        with intervals.",
    )
    .default("[]"),
    Key::new(
        "energy",
        "true or false",
        "true",
        "Whether the balance of energy of a flow with inertia is written to energy.csv: kinetic energy, work, and what viscosity, \
        lubrication films and contacts dissipate; method.constraint = \"sharp\" only.",
    )
    .default("false")
    .needs("time.end = 1.0; flow.model = \"navier-stokes\"; flow.density = 1.0"),
    Key::new(
        "reference_velocity",
        "list of numbers",
        "[1.0, 0.0]",
        "Velocity of the stream to which forces on bodies with prescribed motion are \
        referred: forces.csv then has coefficients of drag and lift.",
    )
    .unit("length/time")
    .range("not zero")
    .needs("time.end = 1.0; flow.density = 1.0; bodies.0.motion = \"fixed\""),
];

/// Most bodies whose motion is given for the forces on them to have a table.
pub const MOST_WITH_FORCES: usize = 16;

/// What a run writes besides its summary.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputSection {
    /// Whether a picture of the flow is written.
    pub picture: bool,
    /// Whether a page of the run is written, and renewed while it runs.
    pub report: bool,
    /// The axes that point right and up in pictures of a scene in three dimensions; absent means such that they show gravity, or else the shear.
    pub plane: Option<[usize; 2]>,
    /// Where that plane cuts the axis across it; absent means in the middle of the box.
    pub plane_at: Option<f64>,
    /// What colours the flow in the picture and in an animation.
    pub colour: Colour,
    /// Time between frames, positive; absent means a hundredth of `time.end`.
    pub every: Option<f64>,
    /// Whether frames hold the flow on the grid; absent means those of a run in time do, and an instantaneous solve writes no frame.
    pub fields: Option<bool>,
    /// Whether frames that hold the flow hold its vorticity too, also where nothing is coloured by it.
    pub vorticity: bool,
    /// Whether frames are shown as VTKHDF too.
    pub vtkhdf: bool,
    /// Whether chains, cells and clusters have tables; absent means where there are any.
    pub objects: Option<bool>,
    /// Seconds of wall time between checkpoints, not negative; 0 means one after every step.
    pub checkpoint: f64,
    /// Points along each axis of the lattice on which the flow, or the scalar, of the end is written, at least two; absent means none.
    pub probe: Option<usize>,
    /// Whether the distribution of pairs is measured.
    pub pairs: bool,
    /// Whether the structure factor is.
    pub structure_factor: bool,
    /// Whether displacements are.
    pub displacements: bool,
    /// Whether the autocorrelation of velocities is.
    pub velocity_autocorrelation: bool,
    /// Axes across which profiles are measured, each once.
    pub profiles: Vec<usize>,
    /// Whether the balance of energy is written, which a flow with inertia has.
    pub energy: bool,
    /// Velocity of the stream to which forces on bodies whose motion is given are referred, not zero; absent means no coefficients of drag and lift.
    pub reference_velocity: Option<Vec<f64>>,
}

/// What colours a flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colour {
    /// The speed.
    Speed,
    /// The speed relative to the motion that a shear gives to all.
    NonAffine,
    /// The vorticity in the plane that is shown, counterclockwise positive.
    Vorticity,
    /// The speed of the fluid, and bodies by the chain, cell or cluster that they belong to.
    Chain,
    /// The speed of the fluid, and bodies by their species: those of one radius are of one.
    Species,
}

impl Default for OutputSection {
    fn default() -> Self {
        OutputSection {
            picture: true,
            report: true,
            plane: None,
            plane_at: None,
            colour: Colour::Speed,
            every: None,
            fields: None,
            vorticity: false,
            vtkhdf: true,
            objects: None,
            checkpoint: 600.0,
            probe: None,
            pairs: false,
            structure_factor: false,
            displacements: false,
            velocity_autocorrelation: false,
            profiles: Vec::new(),
            energy: false,
            reference_velocity: None,
        }
    }
}

impl OutputSection {
    pub(in crate::scene) fn read(root: &Table, dimension: usize, flow: &FlowSection) -> Result<Self> {
        let model = flow.model;
        let table = root.section("output", &KEYS)?;
        if root.get("time").is_none() {
            refuse_frames(&table, model)?;
        }
        let mut default = OutputSection::default();
        if let Some(Drive::ShearRate(Protocol::Steady(rate)) | Drive::ShearedBox(Protocol::Steady(rate))) = flow.drive
            && rate != 0.0
        {
            default.colour = Colour::NonAffine;
        }
        Ok(OutputSection {
            picture: table.get("picture").map_or(Ok(default.picture), |entry| entry.flag())?,
            report: table.get("report").map_or(Ok(default.report), |entry| entry.flag())?,
            plane: table.get("plane").map(|entry| read_plane(&entry, dimension)).transpose()?,
            plane_at: table.get("plane_at").map(|entry| read_plane_at(&entry, dimension)).transpose()?,
            colour: table.get("colour").map_or(Ok(default.colour), |entry| read_colour(&entry, model))?,
            every: table.get("every").map(|entry| entry.positive()).transpose()?,
            fields: table.get("fields").map(|entry| read_fields(&entry, model)).transpose()?,
            vorticity: table.get("vorticity").map_or(Ok(default.vorticity), |entry| read_vorticity(&entry, model))?,
            vtkhdf: table.get("vtkhdf").map_or(Ok(default.vtkhdf), |entry| entry.flag())?,
            objects: table.get("objects").map(|entry| entry.flag()).transpose()?,
            checkpoint: table.get("checkpoint").map_or(Ok(default.checkpoint), |entry| entry.not_negative())?,
            probe: table.get("probe").map(|entry| read_probe(&entry, model)).transpose()?,
            pairs: table.get("pairs").map_or(Ok(default.pairs), |entry| read_pairs(&entry, model))?,
            structure_factor: table
                .get("structure_factor")
                .map_or(Ok(default.structure_factor), |entry| read_structure_factor(&entry, model))?,
            displacements: table.get("displacements").map_or(Ok(default.displacements), |entry| entry.flag())?,
            velocity_autocorrelation: table
                .get("velocity_autocorrelation")
                .map_or(Ok(default.velocity_autocorrelation), |entry| entry.flag())?,
            profiles: table.get("profiles").map_or(Ok(Vec::new()), |entry| read_profiles(&entry, dimension, model))?,
            energy: table.get("energy").map_or(Ok(default.energy), |entry| entry.flag())?,
            reference_velocity: table.get("reference_velocity").map(|entry| read_reference(&entry, dimension)).transpose()?,
        })
    }
}

fn refuse_frames(table: &Table, model: FlowModel) -> Result<()> {
    if let Some(entry) = ["every", "checkpoint"].into_iter().find_map(|name| table.get(name)) {
        return Err(entry.refuse("an instantaneous solve writes one frame at most and no checkpoints; add [time] or remove it"));
    }
    if let Some(entry) = ["displacements", "velocity_autocorrelation", "objects"].into_iter().find_map(|name| table.get(name)) {
        return Err(entry.refuse("an instantaneous solve moves no body; add [time] or remove it"));
    }
    match ["fields", "vtkhdf"].into_iter().find_map(|name| table.get(name)).filter(|_| model == FlowModel::Scalar) {
        Some(entry) => Err(entry.refuse("a scalar around inclusions has no frame; remove it, and read picture and probe instead")),
        None => Ok(()),
    }
}

/// Planes of pictures by their words.
pub(in crate::scene) const PLANES: [(&str, [usize; 2]); 3] = [("xy", [0, 1]), ("xz", [0, 2]), ("yz", [1, 2])];

fn read_plane(entry: &Entry, dimension: usize) -> Result<[usize; 2]> {
    let plane = entry.choice(&PLANES, &[])?;
    entry.expect(plane, dimension == 3, "a scene in two dimensions has one plane; remove it")
}

fn read_plane_at(entry: &Entry, dimension: usize) -> Result<f64> {
    let place = entry.number()?;
    entry.expect(place, dimension == 3, "a scene in two dimensions has one plane; remove it")
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
    pub(in crate::scene) const WORDS: [(&str, Colour); 5] = [
        ("speed", Colour::Speed),
        ("nonaffine", Colour::NonAffine),
        ("vorticity", Colour::Vorticity),
        ("chain", Colour::Chain),
        ("species", Colour::Species),
    ];

    /// Whether bodies have colours of their own, flow or not.
    pub fn of_bodies(self) -> bool {
        matches!(self, Colour::Chain | Colour::Species)
    }
}

fn read_colour(entry: &Entry, model: FlowModel) -> Result<Colour> {
    let colour = entry.choice(&Colour::WORDS, &[])?;
    let known = model.fluid() || colour.of_bodies() || colour == OutputSection::default().colour;
    entry.expect(colour, known, "only a flow is coloured so; remove it")
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
    let remedy = "inclusions of a scalar (flow.model = \"scalar\") have no profiles; remove it";
    let right = axes.is_empty() || model != FlowModel::Scalar;
    entry.expect(axes, right, remedy)
}

fn read_pairs(entry: &Entry, model: FlowModel) -> Result<bool> {
    let pairs = entry.flag()?;
    let remedy = "inclusions of a scalar (flow.model = \"scalar\") have no pair distribution; remove it";
    entry.expect(pairs, !pairs || model != FlowModel::Scalar, remedy)
}

fn read_structure_factor(entry: &Entry, model: FlowModel) -> Result<bool> {
    let measured = entry.flag()?;
    let remedy = "inclusions of a scalar (flow.model = \"scalar\") have no structure factor; remove it";
    entry.expect(measured, !measured || model != FlowModel::Scalar, remedy)
}
