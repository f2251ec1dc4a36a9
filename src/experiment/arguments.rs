//! Arguments that the commands of experiments share.

use std::{ops::RangeBounds, path::PathBuf};

use clap::builder::RangedU64ValueParser;

use crate::{error::Result, petsc::Session, scene::Scene};

/// Options for PETSc, as words.
pub type PetscOptions = [String];

/// How runs are started.
pub struct Start<'a> {
    /// The command line of the launcher, in which `{ranks}` stands for the number of ranks.
    pub launcher: &'a str,
    /// Options for PETSc.
    pub petsc: &'a PetscOptions,
    /// Ranks of each run.
    pub ranks: usize,
}

/// The scene that a command is about.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct SceneArguments {
    /// Scene file.
    pub scene: PathBuf,
    /// Override a key of the scene: --set resolution.cells_per_radius=8
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
}

impl SceneArguments {
    /// Reads it on all ranks.
    ///
    /// # Errors
    /// The scene cannot be used.
    pub fn read(&self, session: &Session) -> Result<Scene> {
        session.world().agree(Scene::read(&self.scene, &self.overrides))
    }
}

/// A whole number of the command line within a range.
pub fn count(range: impl RangeBounds<u64>) -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(range)
}

/// A positive number of the command line.
pub fn positive(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("must be a positive number".into()),
    }
}
