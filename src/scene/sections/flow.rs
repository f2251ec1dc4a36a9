//! The fluid of a scene, if it has one.

use crate::error::Result;
use crate::geometry::Protocol;
use crate::scene::entry::Entry;
use crate::scene::key::Key;
use crate::scene::sections::protocol::{read as read_protocol, read_factor, read_stress};
use crate::scene::table::Table;

/// Keys of `flow.drive`, which exclude each other.
pub(in crate::scene) const DRIVES: [&str; 6] =
    ["mean_velocity", "pressure_gradient", "body_force", "shear_rate", "shear_stress", "mean_gradient"];

/// Keys of `[flow]`.
pub(in crate::scene) const KEYS: [Key; 5] = [
    Key::new(
        "model",
        "\"stokes\", \"navier-stokes\", \"none\" or \"scalar\"",
        "\"stokes\"",
        "The equations: viscous flow without inertia, with \
        inertia of fluid and bodies, no fluid (dry bodies with inertia), or a scalar around inclusions in which it is constant.",
    )
    .default("\"stokes\""),
    Key::new("viscosity", "number", "2.0", "Dynamic viscosity of the fluid.")
        .unit("mass/(length time); 2D: mass/time")
        .default("1.0")
        .range("above 0"),
    Key::new("density", "number", "1.0", "Density of the fluid. In Stokes flow it gives buoyancy only.")
        .unit("mass/volume; 2D: mass/area")
        .default("0.0")
        .range("at least 0; above 0 with \"navier-stokes\""),
    Key::new("drive", "table", "{ mean_velocity = [1.0, 0.0] }", "What moves the fluid besides walls and bodies."),
    Key::new("source", "number", "2.0", "Source of the scalar per volume outside of inclusions.")
        .default("1.0; 0 with a mean_gradient")
        .needs(SCALAR),
];

/// What makes a scene of the reference one of a scalar.
const SCALAR: &str = "domain.x = \"walls\"; flow.model = \"scalar\"";

/// Keys of `flow.drive`.
pub(in crate::scene) const DRIVE_KEYS: [Key; 8] = [
    Key::new("mean_velocity", "list of numbers", "[1.0, 0.0]", "Mean velocity over the whole box, bodies included.")
        .unit("length/time")
        .range("0 along walled axes"),
    Key::new("pressure_gradient", "list of numbers", "[-1.0, 0.0]", "Mean pressure gradient; it acts on bodies too.")
        .unit("pressure/length")
        .range("0 along walled axes"),
    Key::new("body_force", "list of numbers", "[1.0, 0.0]", "Force per volume on the fluid alone.").unit("force/volume"),
    Key::new(
        "factor",
        "number, table, or list of tables",
        "{ amplitude = 1.0, frequency = 0.5 }",
        "What the pressure gradient or the body force is multiplied by: it oscillates by { amplitude, frequency }, or goes by steps [{ until, value }, ..].",
    )
    .default("1.0")
    .needs("domain.y = \"walls\"; time.end = 1.0; flow.drive.pressure_gradient = [-1.0, 0.0]"),
    Key::new(
        "shear_rate",
        "number, table, or list of tables",
        "1.0",
        "Rate of the shear (rate y, 0, 0): of a box that is periodic along all axes, or of walls across y that move oppositely along x. It oscillates by \
        { amplitude, frequency }, or goes by steps [{ until, rate }, ..].",
    )
    .unit("1/time")
    .needs("domain.y = \"periodic\""),
    Key::new(
        "shear_stress",
        "number, or list of tables",
        "5.0",
        "Mean shear stress of the suspension, contacts included, which decides the rate in every step: of a box whose images slide, or of walls across y that \
        move oppositely along x. It goes by steps [{ until, stress }, ..].",
    )
    .unit("pressure")
    .range("not 0")
    .needs("domain.y = \"walls\"; time.end = 1.0"),
    Key::new("mean_gradient", "list of numbers", "[1.0, 0.0]", "Mean gradient of a scalar in a box that is periodic along all axes.")
        .unit("1/length")
        .range("not zero")
        .needs("domain.y = \"periodic\"; flow.model = \"scalar\""),
    Key::new(
        "periodic",
        "\"fixed\" or \"sheared\"",
        "\"sheared\"",
        "How the images of a sheared box lie: at rest (one instant), or sliding along \
        x with the shear (Lees and Edwards; runs in time).",
    )
    .default("\"fixed\", that is at rest")
    .needs("domain.y = \"periodic\"; flow.drive.shear_rate = 1.0; time.end = 1.0"),
];

/// The fluid and what drives it; in a dry scene nothing but the model has a meaning, in a scalar one the source besides.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowSection {
    /// The equations.
    pub model: FlowModel,
    /// Dynamic viscosity, positive.
    pub viscosity: f64,
    /// Mass of the fluid per volume, not negative; in Stokes flow it gives buoyancy only, with inertia it is positive.
    pub density: f64,
    /// What moves the fluid besides walls and bodies.
    pub drive: Option<Drive>,
    /// What a pressure gradient or a body force is multiplied by over time: the rate of this protocol.
    pub drive_factor: Protocol,
    /// Source of the scalar per volume outside the inclusions; only scalar scenes have one.
    pub source: f64,
}

/// The equations of the fluid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlowModel {
    /// No fluid: dry bodies, which have inertia.
    None,
    /// No fluid but a scalar: `-Lap u = source` around inclusions in which it is constant.
    Scalar,
    /// Viscous flow without inertia.
    Stokes,
    /// Viscous flow with inertia, of the fluid and of bodies.
    NavierStokes,
}

/// What moves the fluid besides walls and bodies.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// The mean velocity over the whole box; zero along walled axes.
    MeanVelocity(Vec<f64>),
    /// The mean pressure gradient; zero along walled axes.
    PressureGradient(Vec<f64>),
    /// A uniform force per volume.
    BodyForce(Vec<f64>),
    /// The rate of the shear `(rate y, 0, 0)`: of a fully periodic box whose images stay, or between walls across y that move oppositely.
    ShearRate(Protocol),
    /// As [`ShearRate`](Drive::ShearRate), where the images of the box go along: those above it slide along x.
    ShearedBox(Protocol),
    /// The mean gradient of a scalar in a fully periodic box.
    MeanGradient(Vec<f64>),
}

impl Default for FlowSection {
    fn default() -> Self {
        FlowSection {
            model: FlowModel::Stokes,
            viscosity: 1.0,
            density: 0.0,
            drive: None,
            drive_factor: Protocol::Steady(1.0),
            source: 1.0,
        }
    }
}

impl FlowSection {
    pub(in crate::scene) fn read(root: &Table, dimension: usize) -> Result<Self> {
        let table = root.section("flow", &KEYS)?;
        let default = FlowSection::default();
        let model = |entry: Entry| entry.choice(&FlowModel::WORDS, &[]);
        let model = table.get("model").map_or(Ok(default.model), model)?;
        for name in ["viscosity", "density", "source"] {
            model.allow(table.get(name))?;
        }
        model.allow_drive(table.get("drive"))?;
        let viscosity = table.get("viscosity").map_or(Ok(default.viscosity), |entry| entry.positive())?;
        let drive = table.get("drive").map(|entry| Drive::read(&entry, dimension, viscosity)).transpose()?;
        let (drive, drive_factor) = drive.map_or((None, default.drive_factor), |(drive, factor)| (Some(drive), factor));
        // a fully periodic box has no wall through which a source could leave
        let source = if matches!(drive, Some(Drive::MeanGradient(_))) { 0.0 } else { default.source };
        Ok(FlowSection {
            model,
            viscosity,
            density: table.get("density").map_or(Ok(default.density), |entry| entry.not_negative())?,
            drive,
            drive_factor,
            source: table.get("source").map_or(Ok(source), |entry| read_source(&entry, model))?,
        })
    }
}

/// A shear whose rate a stress decides, at first as in the fluid alone.
fn read_source(entry: &Entry, model: FlowModel) -> Result<f64> {
    let source = entry.number()?;
    let remedy = "only a scalar (flow.model = \"scalar\") has a source; a fluid is driven by flow.drive";
    entry.expect(source, model == FlowModel::Scalar, remedy)
}

impl FlowModel {
    /// Words of the models.
    pub(in crate::scene) const WORDS: [(&str, FlowModel); 4] = [
        ("none", FlowModel::None),
        ("scalar", FlowModel::Scalar),
        ("stokes", FlowModel::Stokes),
        ("navier-stokes", FlowModel::NavierStokes),
    ];

    /// Whether a fluid flows.
    pub fn fluid(self) -> bool {
        matches!(self, FlowModel::Stokes | FlowModel::NavierStokes)
    }

    /// Refuses a drive where there is no fluid: neither does a gradient act on dry bodies, nor do images of a dry box slide.
    fn allow_drive(self, entry: Option<Entry>) -> Result<()> {
        let remedy = "drives a fluid, and a dry scene (flow.model = \"none\") has none; shear dry bodies by walls that move, with contact.friction, or pull \
                      them by gravity";
        entry.filter(|_| self == FlowModel::None).map_or(Ok(()), |entry| Err(entry.refuse(remedy)))
    }

    /// Refuses an entry that means nothing without a fluid.
    pub(in crate::scene) fn allow(self, entry: Option<Entry>) -> Result<()> {
        match entry.filter(|_| self == FlowModel::None) {
            Some(entry) => Err(entry.refuse("a dry scene (flow.model = \"none\") has no fluid; remove it")),
            None => Ok(()),
        }
    }
}

impl Drive {
    /// A drive, and what it is multiplied by over time.
    fn read(entry: &Entry, dimension: usize, viscosity: f64) -> Result<(Self, Protocol)> {
        let table = Table::of(entry, &DRIVE_KEYS)?;
        let (name, entry) = table.exactly_one(&DRIVES, "{ shear_rate = 1.0 }")?;
        let sheared = table.get("periodic").map_or(Ok(false), |entry| {
            entry.expect((), name.starts_with("shear"), "belongs to shear_rate and shear_stress; remove it")?;
            entry.choice(&[("fixed", false), ("sheared", true)], &[])
        })?;
        let factor = table.get("factor").map_or(Ok(Protocol::Steady(1.0)), |entry| {
            entry.expect(
                (),
                ["pressure_gradient", "body_force"].contains(&name),
                "belongs to pressure_gradient and body_force; remove it",
            )?;
            read_factor(&entry)
        })?;
        let drive = match name {
            "mean_velocity" => Drive::MeanVelocity(entry.vector(dimension)?),
            "pressure_gradient" => Drive::PressureGradient(entry.vector(dimension)?),
            "body_force" => Drive::BodyForce(entry.vector(dimension)?),
            "mean_gradient" => Drive::MeanGradient(entry.vector(dimension)?),
            word => {
                let protocol = if word == "shear_stress" { read_stress(&entry, viscosity)? } else { read_protocol(&entry)? };
                if sheared { Drive::ShearedBox(protocol) } else { Drive::ShearRate(protocol) }
            }
        };
        Ok((drive, factor))
    }
}
