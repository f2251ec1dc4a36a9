//! `displacements.csv`: mean-square displacements of a run, from its frames once it has ended.

use std::path::PathBuf;

use super::configurations::measured_by_first_rank;
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
        let (free, shear) = (motion.simulation.free(), view.shear());
        let names = ["displacements.csv", "displacements.svg"];
        let (of_run, written) = measured_by_first_rank(view, motion, &self.folder, names, |frames| {
            let mut found = Displacements::new(motion.domain(), shear);
            let first = frames.visit_all(|frame| {
                let centers = frame.bodies.iter().zip(&free).filter(|(_, free)| **free).map(|(body, _)| body.center);
                found.add(frame.time, &centers.collect::<Vec<_>>());
            })?;
            let files = displacement_files(view.scene.shown_title(), &found);
            Ok(first.map(|first| (DisplacementSummary::new(&found, first), files)))
        })?;
        summary.displacements = of_run;
        Ok(written)
    }
}
