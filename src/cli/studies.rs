//! `turbid scaling` and `turbid inverses`: words become studies that start runs.

use std::path::{Path, PathBuf};

use crate::{
    error::{Error, Result},
    parallel::launched,
    study::{self, InverseOptions, Network, ScalingOptions},
};

/// How runs are started, and how often.
#[derive(Debug, clap::Args)]
pub struct StartArguments {
    /// Command that starts a program on {ranks} ranks.
    #[arg(long, default_value = "mpirun --oversubscribe -n {ranks}")]
    pub launcher: String,
    /// Runs of each setting, of which the fastest counts.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub repeat: u32,
}

/// How to measure.
#[derive(Debug, clap::Args)]
pub struct ScalingArguments {
    /// Numbers of ranks.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2])]
    ranks: Vec<usize>,
    #[command(flatten)]
    starts: StartArguments,
    /// Folder for tables and chart (default: out/NAME-scaling of the scene).
    #[arg(long)]
    out: Option<PathBuf>,
    /// Cores that the launcher reaches (default: those of this machine); more ranks than these are marked.
    #[arg(long)]
    cores: Option<usize>,
    /// Model: gigabytes a second that a rank sends.
    #[arg(long, default_value_t = 5.0, value_parser = positive)]
    bandwidth: f64,
    /// Model: microseconds that a message takes.
    #[arg(long, default_value_t = 2.0, value_parser = positive)]
    latency: f64,
}

/// Measures the scaling of a scene file with overrides.
///
/// # Errors
/// This process is one of several ranks, or the study cannot be made.
pub fn scaling((scene, overrides): (&Path, &[String]), arguments: &ScalingArguments, petsc: &[String]) -> Result<()> {
    refuse_ranks()?;
    study::scaling(&ScalingOptions {
        scene: scene.to_owned(),
        overrides: overrides.to_vec(),
        ranks: arguments.ranks.clone(),
        launcher: arguments.starts.launcher.clone(),
        repeat: arguments.starts.repeat as usize,
        out: arguments.out.clone(),
        cores: arguments.cores,
        network: Network { bandwidth: arguments.bandwidth * 1e9, latency: arguments.latency * 1e-6 },
        petsc: petsc.to_vec(),
    })
}

/// Which runs to compare.
#[derive(Debug, clap::Args)]
pub struct InverseArguments {
    /// Scene files.
    #[arg(required = true)]
    scenes: Vec<PathBuf>,
    /// Override a key of each scene: --set bodies.0.count=100
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Numbers of ranks.
    #[arg(long, value_delimiter = ',', default_values_t = [1])]
    ranks: Vec<usize>,
    #[command(flatten)]
    starts: StartArguments,
}

/// Compares the inverses of the fluid on scenes.
///
/// # Errors
/// This process is one of several ranks, or a run fails.
pub fn inverses(arguments: &InverseArguments, petsc: &[String]) -> Result<()> {
    refuse_ranks()?;
    study::inverses(&InverseOptions {
        scenes: arguments.scenes.clone(),
        overrides: arguments.overrides.clone(),
        ranks: arguments.ranks.clone(),
        launcher: arguments.starts.launcher.clone(),
        repeat: arguments.starts.repeat as usize,
        petsc: petsc.to_vec(),
    })
}

/// Refuses to be one of several ranks.
pub fn refuse_ranks() -> Result<()> {
    if launched() { Err(ranks_refused()) } else { Ok(()) }
}

/// The refusal to be one of several ranks.
pub fn ranks_refused() -> Error {
    Error::refused(
        "this study starts its own ranks: call `turbid scaling SCENE --ranks 1,2,4` (or `turbid cost SCENE`, `turbid inverses SCENE..`, `turbid viscosity`) without mpirun; \
         --launcher says how they start",
    )
}

/// A positive number of the command line.
pub fn positive(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("must be a positive number".into()),
    }
}
