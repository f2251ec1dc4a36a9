//! `displacements.csv`: mean-square displacements of a run, from its frames once it has ended.

use std::path::PathBuf;

use super::configurations::{Configurations, steady_from};
use crate::run::outputs::context::{Context, Wanted};
use crate::{
    error::Result,
    observe::Displacements,
    output::{DisplacementSummary, Summary, displacement_files},
    run::{Output, View},
};

/// Measures displacements at the end.
pub struct DisplacementFiles {
    /// Where the files go, and where the frames are.
    pub folder: PathBuf,
}

/// With `output.displacements`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.displacements, |context| DisplacementFiles { folder: context.path() })
}

impl<const D: usize> Output<D> for DisplacementFiles {
    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let Some(motion) = &view.motion else { return Ok(Vec::new()) };
        let shear = view.shear();
        let begin = steady_from(view.world, shear.as_ref(), motion.state().time, view.history.mean());
        let free = motion.simulation.free();
        // one rank alone: paths need all frames in turn
        let found = view.world.on_first_rank(|| {
            let mut found = Displacements::new(motion.domain(), shear);
            let first = Configurations::since(begin, &self.folder)?.visit_all(|frame| {
                let centers = frame.bodies.iter().zip(&free).filter(|(_, free)| **free).map(|(body, _)| body.center);
                found.add(frame.time, &centers.collect::<Vec<_>>());
            })?;
            let files = displacement_files(view.scene.shown_title(), &found);
            Ok(first.map(|first| (DisplacementSummary::new(&found, first), files)))
        })?;
        if view.world.max(f64::from(found.is_some())) == 0.0 {
            return Ok(Vec::new());
        }
        let (of_run, files) = found.unzip();
        summary.displacements = of_run;
        let files = files.unwrap_or_else(|| ["displacements.csv", "displacements.svg"].map(|name| (name, Vec::new())));
        files.iter().map(|(name, bytes)| view.write_file(&self.folder, name, bytes)).collect()
    }
}
