//! What outputs are opened from.

use std::path::{Path, PathBuf};

use crate::{error::Result, motion::Simulation, parallel::World, run::Output, scene::Scene};

/// An output, or nothing where a scene does not call for it.
pub type Wanted<const D: usize> = Result<Option<Box<dyn Output<D>>>>;

/// A run whose outputs are opened.
pub struct Context<'a, const D: usize> {
    /// All ranks.
    pub world: &'a World,
    /// What is simulated.
    pub scene: &'a Scene,
    /// Where files go.
    pub folder: &'a Path,
    /// What checkpoints hold of the scene.
    pub texts: &'a [(&'static str, String)],
    /// What moves the bodies; nothing at an instant.
    pub simulation: Option<&'a Simulation<D>>,
}

impl<const D: usize> Context<'_, D> {
    /// Where files go.
    pub fn path(&self) -> PathBuf {
        self.folder.to_owned()
    }

    /// The time of the first instant that is written: 0 but for a run that goes on.
    pub fn time(&self) -> f64 {
        self.simulation.map_or(0.0, |simulation| simulation.state().time)
    }

    /// An output if it is wanted.
    pub fn when<O: Output<D> + 'static>(&self, wanted: bool, output: impl FnOnce(&Self) -> O) -> Wanted<D> {
        Ok(wanted.then(|| boxed(output(self))))
    }
}

/// An output among others.
pub fn boxed<const D: usize>(output: impl Output<D> + 'static) -> Box<dyn Output<D>> {
    Box::new(output)
}
