//! What `turbid cost` is asked for.

use std::path::PathBuf;

use crate::{
    error::{Error, Result},
    experiment::launcher::StartArguments,
    study::command::{SceneArguments, count, positive},
};

/// Budget of a method where nobody lists the grids.
const BUDGET: f64 = 60.0;

/// What to measure, and how; empty lists leave the choice to the scene.
#[derive(Debug, Clone, clap::Args)]
pub struct CostStudy {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Constraint methods (default: all that the scene allows).
    #[arg(long, value_delimiter = ',')]
    pub methods: Vec<String>,
    /// Grids, in cells per radius of the smallest body (default: a sequence that suits the scene).
    #[arg(long, value_delimiter = ',', conflicts_with = "spacings")]
    pub resolutions: Vec<f64>,
    /// Grids, as spacings.
    #[arg(long, value_delimiter = ',')]
    pub spacings: Vec<f64>,
    /// Orders of surface modes (default: automatic on every grid).
    #[arg(long, value_delimiter = ',')]
    pub modes: Vec<usize>,
    /// Relative residuals at which solves end (default: the scene's).
    #[arg(long, value_delimiter = ',')]
    pub tolerances: Vec<f64>,
    /// Time steps (default: the scene's step or travel, twice and half of it; automatic ones of a flow with inertia follow the grid).
    #[arg(long, value_delimiter = ',', conflicts_with = "travels")]
    pub steps: Vec<f64>,
    /// Automatic steps: parts of its radius that a body moves in one.
    #[arg(long, value_delimiter = ',')]
    pub travels: Vec<f64>,
    /// drag, viscosity, resistance, mean-velocity, velocity, reynolds, value, energy, position, field or gradient (default: what suits the scene).
    #[arg(long)]
    pub quantity: Option<String>,
    /// Number of the body whose quantity it is, from 0 (default: all of them).
    #[arg(long)]
    pub body: Option<usize>,
    /// Points along each axis of the lattice on which fields are compared.
    #[arg(long, value_parser = count(2..=1000))]
    pub probe: Option<usize>,
    /// True value of the quantity (default: the limit of the finest grids, with its own uncertainty).
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    pub exact: Vec<f64>,
    /// How far that may be off.
    #[arg(long, default_value_t = 0.0, value_parser = not_negative)]
    pub uncertainty: f64,
    /// Method whose limit counts as true (default: sharp).
    #[arg(long, conflicts_with = "exact")]
    pub reference: Option<String>,
    /// Wanted relative error.
    #[arg(long, default_value_t = 1e-2, value_parser = positive)]
    pub error: f64,
    /// Seconds of runs that a method may take (default: 60, or as many as it takes where grids are listed).
    #[arg(long, value_parser = positive)]
    pub budget: Option<f64>,
    /// Time at which runs in time end (default: that of the scene).
    #[arg(long, value_parser = positive)]
    pub until: Option<f64>,
    /// Ranks of each run.
    #[arg(long, default_value_t = 1, value_parser = count(1..))]
    pub ranks: usize,
    /// How runs are started.
    #[command(flatten)]
    pub start: StartArguments,
    /// Folder for results; a study that was interrupted goes on there (default: out/NAME-cost of the scene).
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Write the scene with the cheapest setting that was found into this file.
    #[arg(long, value_name = "FILE")]
    pub apply: Option<PathBuf>,
    /// Forget what was measured before.
    #[arg(long)]
    pub fresh: bool,
}

impl CostStudy {
    /// Seconds of runs that a method may take: without end where grids are listed.
    pub fn seconds(&self) -> f64 {
        let listed = !(self.resolutions.is_empty() && self.spacings.is_empty());
        self.budget.unwrap_or(if listed { f64::INFINITY } else { BUDGET })
    }

    /// Refuses names that lead nowhere before anything is run.
    pub fn check_names(&self, methods: &[String]) -> Result<()> {
        if let Some(method) = self.reference.as_ref().filter(|method| !methods.contains(method)) {
            let known = methods.join(", ");
            return Err(Error::refused(format!("--reference {method}: must be one of the methods that are swept, {known}")));
        }
        let folder =
            |path: &PathBuf| path.parent().map(|folder| if folder.as_os_str().is_empty() { ".".into() } else { folder.to_owned() });
        match self.apply.as_ref().and_then(|path| Some((path, folder(path)?))) {
            Some((path, folder)) if !folder.is_dir() => {
                Err(Error::refused(format!("--apply {}: there is no folder {}; make it first", path.display(), folder.display())))
            }
            _ => Ok(()),
        }
    }
}

fn not_negative(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err("must be a number that is not negative".into()),
    }
}

#[cfg(test)]
impl Default for CostStudy {
    fn default() -> CostStudy {
        crate::study::command::from_words(&["scene.toml"])
    }
}
