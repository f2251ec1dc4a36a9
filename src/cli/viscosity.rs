//! `turbid viscosity`: words become a study that starts runs.

use std::path::PathBuf;

use super::studies::{positive, refuse_ranks};
use crate::{
    error::Result,
    study::{self, ViscosityOptions},
};

/// What to measure, and how.
#[derive(Debug, clap::Args)]
pub struct ViscosityArguments {
    /// Dimensions of space.
    #[arg(long, value_delimiter = ',', default_values_t = [2, 3])]
    dimensions: Vec<usize>,
    /// Fractions at which configurations in equilibrium are solved at an instant.
    #[arg(long, value_delimiter = ',', default_values_t = [0.05, 0.1, 0.2, 0.3, 0.4])]
    fractions: Vec<f64>,
    /// Configurations of each fraction, whose scatter gives the error bar.
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    configurations: u32,
    /// Bodies of each configuration (default: 64 in 2D, 27 in 3D).
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    bodies: Option<u32>,
    /// Cells per radius (default: 5 in 2D, 4 in 3D).
    #[arg(long, value_parser = positive)]
    cells_per_radius: Option<f64>,
    /// Smallest gap between bodies at an instant, in radii.
    #[arg(long, default_value_t = 0.02, value_parser = positive)]
    gap: f64,
    /// Fraction of the runs in time, one in each dimension.
    #[arg(long, default_value_t = 0.3)]
    sheared_fraction: f64,
    /// Strain of the runs in time (0: none).
    #[arg(long, default_value_t = 2.0)]
    strain: f64,
    /// Ranks of each run.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    ranks: u32,
    /// Command that starts a program on {ranks} ranks.
    #[arg(long, default_value = "mpirun --oversubscribe -n {ranks}")]
    launcher: String,
    /// Folder for results; a study that was interrupted goes on there.
    #[arg(long, default_value = "out/viscosity")]
    out: PathBuf,
    /// Forget what was measured before.
    #[arg(long)]
    fresh: bool,
}

/// Measures viscosity against fraction and strain.
///
/// # Errors
/// This process is one of several ranks, or the study cannot be made.
pub fn viscosity(arguments: &ViscosityArguments, petsc: &[String]) -> Result<()> {
    refuse_ranks()?;
    study::viscosity(&ViscosityOptions {
        dimensions: arguments.dimensions.clone(),
        fractions: arguments.fractions.clone(),
        configurations: arguments.configurations as usize,
        bodies: arguments.bodies.map(|bodies| bodies as usize),
        cells_per_radius: arguments.cells_per_radius,
        gap: arguments.gap,
        sheared_fraction: arguments.sheared_fraction,
        strain: arguments.strain,
        ranks: arguments.ranks as usize,
        launcher: arguments.launcher.clone(),
        out: arguments.out.clone(),
        fresh: arguments.fresh,
        petsc: petsc.to_vec(),
    })
}
