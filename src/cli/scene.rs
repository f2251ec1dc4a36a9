//! A scene of the command line: a file and what is overridden in it.

use std::path::PathBuf;

use crate::{error::Result, petsc::Session, scene::Scene};

/// Which scene.
#[derive(Debug, clap::Args)]
pub struct SceneArguments {
    /// Scene file.
    pub scene: PathBuf,
    /// Override a key of the scene: --set resolution.cells_per_radius=8
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
}

impl SceneArguments {
    /// The scene of the file, with its overrides; collective.
    ///
    /// # Errors
    /// It is refused.
    pub fn read(&self, session: &Session) -> Result<Scene> {
        session.world().agree(Scene::read(&self.scene, &self.overrides))
    }
}
