//! `velocity-autocorrelation.csv`: how long bodies keep their velocities, from the frames of a run once it has ended.

use std::path::PathBuf;

use super::configurations::{Configurations, steady_from};
use crate::run::outputs::context::{Context, Wanted};
use crate::{
    error::Result,
    observe::Autocorrelation,
    output::{AutocorrelationSummary, Summary, autocorrelation_files},
    run::{Output, View},
};

/// Measures the velocity autocorrelation at the end.
pub struct AutocorrelationFiles {
    /// Where the files go, and where the frames are.
    pub folder: PathBuf,
}

/// With `output.velocity_autocorrelation`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.velocity_autocorrelation, |context| AutocorrelationFiles { folder: context.path() })
}

impl<const D: usize> Output<D> for AutocorrelationFiles {
    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let Some(motion) = &view.motion else { return Ok(Vec::new()) };
        let shear = view.shear();
        let begin = steady_from(view.world, shear.as_ref(), motion.state().time, view.history.mean());
        let free = motion.simulation.free();
        // one rank alone: a lag takes two frames
        let found = view.world.on_first_rank(|| {
            let mut found = Autocorrelation::new(motion.domain(), shear);
            let first = Configurations::since(begin, &self.folder)?.visit_all(|frame| {
                let bodies = frame.bodies.iter().zip(&free).filter(|(_, free)| **free).map(|(body, _)| (body.center, body.velocity));
                found.add(frame.time, &bodies.collect::<Vec<_>>());
            })?;
            let files = autocorrelation_files(view.scene.shown_title(), &found);
            Ok(first.map(|first| (AutocorrelationSummary::new(&found, first), files)))
        })?;
        if view.world.max(f64::from(found.is_some())) == 0.0 {
            return Ok(Vec::new());
        }
        let (of_run, files) = found.unzip();
        summary.velocity_autocorrelation = of_run;
        let files =
            files.unwrap_or_else(|| ["velocity-autocorrelation.csv", "velocity-autocorrelation.svg"].map(|name| (name, Vec::new())));
        files.iter().map(|(name, bytes)| view.write_file(&self.folder, name, bytes)).collect()
    }
}
