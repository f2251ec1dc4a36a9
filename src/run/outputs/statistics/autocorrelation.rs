//! `velocity-autocorrelation.csv`: how long bodies keep their velocities, from the frames of a run once it has ended.

use std::path::PathBuf;

use super::configurations::measured_by_first_rank;
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
        let (free, shear) = (motion.simulation.free(), view.shear());
        let names = ["velocity-autocorrelation.csv", "velocity-autocorrelation.svg"];
        let (of_run, written) = measured_by_first_rank(view, motion, &self.folder, names, |frames| {
            let mut found = Autocorrelation::new(motion.domain(), shear);
            let first = frames.visit_all(|frame| {
                let bodies = frame.bodies.iter().zip(&free).filter(|(_, free)| **free).map(|(body, _)| (body.center, body.velocity));
                found.add(frame.time, &bodies.collect::<Vec<_>>());
            })?;
            let files = autocorrelation_files(view.scene.shown_title(), &found);
            Ok(first.map(|first| (AutocorrelationSummary::new(&found, first), files)))
        })?;
        summary.velocity_autocorrelation = of_run;
        Ok(written)
    }
}
