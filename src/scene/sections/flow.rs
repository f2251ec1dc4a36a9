//! The fluid of a scene, if it has one.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

/// Keys of `flow.drive`, which exclude each other.
pub(in crate::scene) const DRIVES: [&str; 5] = ["mean_velocity", "pressure_gradient", "body_force", "shear_rate", "mean_gradient"];

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
    /// The rate of the background shear `(rate y, 0, 0)` of a fully periodic box.
    ShearRate(f64),
    /// As [`ShearRate`](Drive::ShearRate), where the images of the box go along: those above it slide along x.
    ShearedBox(f64),
    /// The mean gradient of a scalar in a fully periodic box.
    MeanGradient(Vec<f64>),
}

impl Default for FlowSection {
    fn default() -> Self {
        FlowSection { model: FlowModel::Stokes, viscosity: 1.0, density: 0.0, drive: None, source: 1.0 }
    }
}

impl FlowSection {
    pub(in crate::scene) fn read(root: &Table, dimension: usize) -> Result<Self> {
        let table = root.section("flow", &["model", "viscosity", "density", "drive", "source"])?;
        let default = FlowSection::default();
        let model = |entry: Entry| entry.choice(&FlowModel::WORDS, &[]);
        let model = table.get("model").map_or(Ok(default.model), model)?;
        for name in ["viscosity", "density", "drive", "source"] {
            model.allow(table.get(name))?;
        }
        let drive = table.get("drive").map(|entry| Drive::read(&entry, dimension)).transpose()?;
        // a fully periodic box has no wall through which a source could leave
        let source = if matches!(drive, Some(Drive::MeanGradient(_))) { 0.0 } else { default.source };
        Ok(FlowSection {
            model,
            viscosity: table.get("viscosity").map_or(Ok(default.viscosity), |entry| entry.positive())?,
            density: table.get("density").map_or(Ok(default.density), |entry| entry.not_negative())?,
            drive,
            source: table.get("source").map_or(Ok(source), |entry| read_source(&entry, model))?,
        })
    }
}

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

    /// Refuses an entry that means nothing without a fluid.
    pub(in crate::scene) fn allow(self, entry: Option<Entry>) -> Result<()> {
        match entry.filter(|_| self == FlowModel::None) {
            Some(entry) => Err(entry.refuse("a dry scene (flow.model = \"none\") has no fluid; remove it")),
            None => Ok(()),
        }
    }
}

impl Drive {
    fn read(entry: &Entry, dimension: usize) -> Result<Self> {
        let table = Table::of(entry, &[&DRIVES[..], &["periodic"]].concat())?;
        let (name, entry) = table.exactly_one(&DRIVES, "{ shear_rate = 1.0 }")?;
        let sheared = table.get("periodic").map_or(Ok(false), |entry| {
            entry.expect((), name == "shear_rate", "belongs to shear_rate; remove it")?;
            entry.choice(&[("fixed", false), ("sheared", true)], &[])
        })?;
        Ok(match name {
            "mean_velocity" => Drive::MeanVelocity(entry.vector(dimension)?),
            "pressure_gradient" => Drive::PressureGradient(entry.vector(dimension)?),
            "body_force" => Drive::BodyForce(entry.vector(dimension)?),
            "mean_gradient" => Drive::MeanGradient(entry.vector(dimension)?),
            _ if sheared => Drive::ShearedBox(entry.number()?),
            _ => Drive::ShearRate(entry.number()?),
        })
    }
}
