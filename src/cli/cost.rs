//! `turbid cost`: words become a study that starts runs.

use std::path::{Path, PathBuf};

use super::studies::{StartArguments, positive, refuse_ranks};
use crate::{
    error::Result,
    study::{self, CostOptions},
};

/// Budget of a method where nobody lists the grids.
const BUDGET: f64 = 60.0;

/// What to measure, and how.
#[derive(Debug, clap::Args)]
pub struct CostArguments {
    /// Constraint methods (default: all that the scene allows).
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    /// Grids, in cells per radius of the smallest body (default: a ladder that suits the scene).
    #[arg(long, value_delimiter = ',', conflicts_with = "spacings")]
    resolutions: Vec<f64>,
    /// Grids, as spacings.
    #[arg(long, value_delimiter = ',')]
    spacings: Vec<f64>,
    /// Orders of surface modes (default: automatic on every grid).
    #[arg(long, value_delimiter = ',')]
    modes: Vec<usize>,
    /// Relative residuals at which solves end (default: the scene's).
    #[arg(long, value_delimiter = ',')]
    tolerances: Vec<f64>,
    /// Time steps (default: the scene's step or travel, twice and half of it).
    #[arg(long, value_delimiter = ',', conflicts_with = "travels")]
    steps: Vec<f64>,
    /// Automatic steps: parts of its radius that a body moves in one.
    #[arg(long, value_delimiter = ',')]
    travels: Vec<f64>,
    /// drag, viscosity, velocity, value, energy, position, field or gradient (default: what suits the scene).
    #[arg(long)]
    quantity: Option<String>,
    /// Number of the body whose quantity it is, from 0 (default: all of them).
    #[arg(long)]
    body: Option<usize>,
    /// Points along each axis of the lattice on which fields are compared.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=1000))]
    probe: Option<u32>,
    /// True value of the quantity (default: the limit of the finest grids, with its own uncertainty).
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    exact: Vec<f64>,
    /// How far that may be off.
    #[arg(long, default_value_t = 0.0, value_parser = not_negative)]
    uncertainty: f64,
    /// Method whose limit counts as true (default: sharp).
    #[arg(long, conflicts_with = "exact")]
    reference: Option<String>,
    /// Wanted relative error.
    #[arg(long, default_value_t = 1e-2, value_parser = positive)]
    error: f64,
    /// Seconds of runs that a method may take (default: 60, or as many as it takes where grids are listed).
    #[arg(long, value_parser = positive)]
    budget: Option<f64>,
    /// Time at which runs in time end (default: that of the scene).
    #[arg(long, value_parser = positive)]
    until: Option<f64>,
    /// Ranks of each run.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    ranks: u32,
    #[command(flatten)]
    starts: StartArguments,
    /// Folder for results; a study that was interrupted goes on there (default: out/NAME-cost of the scene).
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write the scene with the cheapest setting that was found into this file.
    #[arg(long, value_name = "FILE")]
    apply: Option<PathBuf>,
    /// Forget what was measured before.
    #[arg(long)]
    fresh: bool,
}

/// Measures what accuracy costs on a scene file with overrides.
///
/// # Errors
/// This process is one of several ranks, or the study cannot be made.
pub fn cost((scene, overrides): (&Path, &[String]), arguments: &CostArguments, petsc: &[String]) -> Result<()> {
    refuse_ranks()?;
    let listed = !(arguments.resolutions.is_empty() && arguments.spacings.is_empty());
    study::cost(&CostOptions {
        scene: scene.to_owned(),
        overrides: overrides.to_vec(),
        methods: arguments.methods.clone(),
        resolutions: arguments.resolutions.clone(),
        spacings: arguments.spacings.clone(),
        modes: arguments.modes.clone(),
        tolerances: arguments.tolerances.clone(),
        steps: arguments.steps.clone(),
        travels: arguments.travels.clone(),
        quantity: arguments.quantity.clone(),
        body: arguments.body,
        probe: arguments.probe.map(|points| points as usize),
        exact: arguments.exact.clone(),
        uncertainty: arguments.uncertainty,
        reference: arguments.reference.clone(),
        error: arguments.error,
        budget: arguments.budget.unwrap_or(if listed { f64::INFINITY } else { BUDGET }),
        until: arguments.until,
        ranks: arguments.ranks as usize,
        launcher: arguments.starts.launcher.clone(),
        repeat: arguments.starts.repeat as usize,
        out: arguments.out.clone(),
        apply: arguments.apply.clone(),
        fresh: arguments.fresh,
        petsc: petsc.to_vec(),
    })
}

fn not_negative(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err("must be a number that is not negative".into()),
    }
}
