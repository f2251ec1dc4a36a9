//! The sections of a scene besides its bodies, and how each is read.

use crate::error::Result;
use crate::scene::entry::Entry;
use crate::scene::table::Table;

/// Keys of `[resolution]` that exclude each other.
pub(super) const SPACINGS: [&str; 2] = ["cells_per_radius", "spacing"];

/// Keys of `flow.drive`, which exclude each other.
pub(super) const DRIVES: [&str; 4] = ["mean_velocity", "pressure_gradient", "body_force", "shear_rate"];

/// The box: its size and what bounds it.
#[derive(Debug, Clone, PartialEq)]
pub struct DomainSection {
    /// Edge lengths; their number is the dimension.
    pub size: Vec<f64>,
    /// What bounds each axis.
    pub axes: Vec<AxisSection>,
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
}

/// The fluid and what drives it.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowSection {
    /// The equations.
    pub model: FlowModel,
    /// Dynamic viscosity, positive.
    pub viscosity: f64,
    /// Mass of the fluid per volume, not negative; in Stokes flow it gives buoyancy only.
    pub density: f64,
    /// What moves the fluid besides walls and bodies.
    pub drive: Option<Drive>,
}

/// The equations of the fluid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlowModel {
    /// Viscous flow without inertia.
    Stokes,
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
}

/// How fine the grid and the multipliers are.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolutionSection {
    /// The grid spacing.
    pub spacing: Spacing,
    /// The multiplier modes of each body.
    pub modes: Modes,
}

/// How the grid spacing is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spacing {
    /// Cells across the radius of the smallest body.
    CellsPerRadius(f64),
    /// A length.
    Length(f64),
}

/// How many multiplier modes each body has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Modes {
    /// As many as the grid supports.
    Auto,
    /// This many, at least one.
    Count(usize),
}

/// How the equations are solved.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSection {
    /// How bodies act on the grid.
    pub constraint: ConstraintMethod,
    /// What solves the Stokes problem of the empty box.
    pub inverse: StokesSolver,
    /// Relative residual at which a solve ends, above 0 and at most 0.1.
    pub tolerance: f64,
}

/// How bodies act on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConstraintMethod {
    /// Multipliers on the surface with jump corrections.
    Sharp,
}

/// What solves the Stokes problem of the empty box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StokesSolver {
    /// Multigrid of hypre.
    Hypre,
}

/// What happens between bodies that touch.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSection {
    /// The law of contact.
    pub model: ContactModel,
}

/// The law of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactModel {
    /// Bodies do not notice contact.
    None,
}

/// What happens between bodies that nearly touch.
#[derive(Debug, Clone, PartialEq)]
pub struct LubricationSection {
    /// The correction for films thinner than the grid.
    pub model: LubricationModel,
}

/// The correction for films thinner than the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LubricationModel {
    /// No correction.
    None,
}

/// What a run writes besides its summary.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputSection {
    /// Whether a picture of the flow is written.
    pub picture: bool,
}

impl DomainSection {
    pub(super) fn read(root: &Table) -> Result<Self> {
        let table = root.section("domain", &["size", "x", "y", "z"])?;
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
        Ok(DomainSection { size, axes })
    }
}

fn read_size(entry: &Entry) -> Result<Vec<f64>> {
    let lengths = entry.list()?;
    let remedy = "must be a list of two numbers (2D) or three (3D)";
    entry.expect((), matches!(lengths.len(), 2 | 3), remedy)?;
    lengths.iter().map(Entry::positive).collect()
}

impl AxisSection {
    fn read(entry: &Entry, axis: usize, dimension: usize) -> Result<Self> {
        const CHOICES: &str = "\"periodic\", \"walls\" or { lower = [..], upper = [..] }";
        if let Ok(word) = entry.text() {
            return match word {
                "periodic" => Ok(AxisSection::Periodic),
                "walls" => Ok(AxisSection::Walls { lower: vec![0.0; dimension], upper: vec![0.0; dimension] }),
                _ => Err(entry.refuse(&format!("must be {CHOICES}"))),
            };
        }
        if !entry.value.is_inline_table() {
            return Err(entry.mistyped(CHOICES));
        }
        let table = entry.table(&["lower", "upper"])?;
        let wall = |name| read_wall(&table.require(name, &format!("{:?}", vec![0.0; dimension]))?, axis, dimension);
        Ok(AxisSection::Walls { lower: wall("lower")?, upper: wall("upper")? })
    }
}

fn read_wall(entry: &Entry, axis: usize, dimension: usize) -> Result<Vec<f64>> {
    let velocity = entry.vector(dimension)?;
    let still = velocity[axis] == 0.0;
    let remedy = format!("number {} must be 0: a wall cannot move along its own axis", axis + 1);
    entry.expect(velocity, still, &remedy)
}

impl FlowSection {
    pub(super) fn read(root: &Table, dimension: usize) -> Result<Self> {
        let table = root.section("flow", &["model", "viscosity", "density", "drive"])?;
        let planned = ["none", "scalar", "navier-stokes"];
        let model = |entry: Entry| entry.choice(&[("stokes", FlowModel::Stokes)], &planned);
        Ok(FlowSection {
            model: table.get("model").map_or(Ok(FlowModel::Stokes), model)?,
            viscosity: table.get("viscosity").map_or(Ok(1.0), |entry| entry.positive())?,
            density: table.get("density").map_or(Ok(0.0), |entry| entry.not_negative())?,
            drive: table.get("drive").map(|entry| Drive::read(&entry, dimension)).transpose()?,
        })
    }
}

impl Drive {
    fn read(entry: &Entry, dimension: usize) -> Result<Self> {
        let (name, entry) = entry.table(&DRIVES)?.exactly_one(&DRIVES, "{ shear_rate = 1.0 }")?;
        Ok(match name {
            "mean_velocity" => Drive::MeanVelocity(entry.vector(dimension)?),
            "pressure_gradient" => Drive::PressureGradient(entry.vector(dimension)?),
            "body_force" => Drive::BodyForce(entry.vector(dimension)?),
            _ => Drive::ShearRate(entry.number()?),
        })
    }
}

impl ResolutionSection {
    pub(super) fn read(root: &Table) -> Result<Self> {
        let table = root.section("resolution", &[&SPACINGS[..], &["modes"]].concat())?;
        let (name, entry) = table.exactly_one(&SPACINGS, "cells_per_radius = 6")?;
        let spacing = match name {
            "spacing" => Spacing::Length(entry.positive()?),
            _ => Spacing::CellsPerRadius(entry.positive()?),
        };
        let modes = table.get("modes").map_or(Ok(Modes::Auto), |entry| Modes::read(&entry))?;
        Ok(ResolutionSection { spacing, modes })
    }
}

impl Modes {
    fn read(entry: &Entry) -> Result<Self> {
        match entry.text() {
            Ok("auto") => Ok(Modes::Auto),
            Ok(_) => Err(entry.refuse("must be \"auto\" or a whole number")),
            Err(_) => Ok(Modes::Count(entry.count()?)),
        }
    }
}

impl MethodSection {
    pub(super) fn read(root: &Table) -> Result<Self> {
        let table = root.section("method", &["constraint", "inverse", "tolerance"])?;
        let planned = ["mean-value", "distributed", "penalty", "fitted"];
        let constraint = |entry: Entry| entry.choice(&[("sharp", ConstraintMethod::Sharp)], &planned);
        let inverse = |entry: Entry| entry.choice(&[("hypre", StokesSolver::Hypre)], &["transform", "auto"]);
        Ok(MethodSection {
            constraint: table.get("constraint").map_or(Ok(ConstraintMethod::Sharp), constraint)?,
            inverse: table.get("inverse").map_or(Ok(StokesSolver::Hypre), inverse)?,
            tolerance: table.get("tolerance").map_or(Ok(1e-6), |entry| read_tolerance(&entry))?,
        })
    }
}

fn read_tolerance(entry: &Entry) -> Result<f64> {
    let tolerance = entry.number()?;
    entry.expect(tolerance, tolerance > 0.0 && tolerance <= 0.1, "must be above 0 and at most 0.1")
}

impl ContactSection {
    pub(super) fn read(root: &Table) -> Result<Self> {
        let table = root.section("contact", &["model"])?;
        let planned = ["inelastic", "repulsion", "gluey"];
        let model = |entry: Entry| entry.choice(&[("none", ContactModel::None)], &planned);
        Ok(ContactSection { model: table.get("model").map_or(Ok(ContactModel::None), model)? })
    }
}

impl LubricationSection {
    pub(super) fn read(root: &Table) -> Result<Self> {
        let table = root.section("lubrication", &["model"])?;
        let model = |entry: Entry| entry.choice(&[("none", LubricationModel::None)], &["pairwise"]);
        Ok(LubricationSection { model: table.get("model").map_or(Ok(LubricationModel::None), model)? })
    }
}

impl OutputSection {
    pub(super) fn read(root: &Table) -> Result<Self> {
        let table = root.section("output", &["picture"])?;
        Ok(OutputSection { picture: table.get("picture").map_or(Ok(true), |entry| entry.flag())? })
    }
}
