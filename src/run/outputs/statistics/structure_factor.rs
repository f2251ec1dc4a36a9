//! `structure-factor.csv`: the structure factor of a run, over its frames once it has ended, or of an instant.

use std::path::{Path, PathBuf};

use nalgebra::SVector;

use super::configurations::{Configurations, box_of, first_time, steady_from};
use crate::run::outputs::context::{Context, Wanted};
use crate::{
    error::Result,
    geometry::Domain,
    observe::StructureFactor,
    output::{StructureFactorSummary, Summary, structure_factor_files},
    run::{Output, View},
};

/// Measures the structure factor at the end.
pub struct StructureFactorFiles {
    /// Where the files go, and where the frames are.
    pub folder: PathBuf,
}

/// With `output.structure_factor`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.structure_factor, |context| StructureFactorFiles { folder: context.path() })
}

impl<const D: usize> Output<D> for StructureFactorFiles {
    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let found = match (&view.motion, view.flow) {
            (Some(motion), _) => {
                let begin = steady_from(view.world, view.shear().as_ref(), motion.state().time, view.history.mean());
                let radii: Vec<f64> = motion.simulation.whole_balls().iter().map(|ball| ball.radius).collect();
                over_frames(view, &self.folder, begin, motion.domain(), &radii)?
            }
            (None, Some(flow)) => {
                let setup = flow.solver.setup();
                let balls = || setup.bodies.iter().map(|suspended| suspended.body.ball);
                let found = StructureFactor::new(&setup.domain, &balls().map(|ball| ball.radius).collect::<Vec<_>>(), 1);
                found.map(|mut found| {
                    found.add(0, &setup.domain, &balls().map(|ball| ball.center).collect::<Vec<_>>());
                    (found, 0.0)
                })
            }
            (None, None) => None,
        };
        let Some((found, from_time)) = found else { return Ok(Vec::new()) };
        let shells = found.shells();
        summary.structure_factor = StructureFactorSummary::new(&shells, found.configurations(), from_time);
        let files = structure_factor_files(view.scene.shown_title(), &shells);
        files.iter().map(|(name, bytes)| view.write_file(&self.folder, name, bytes)).collect()
    }
}

/// Over the frames of a run from a time on, and the time of the first; all ranks find the same. Collective.
fn over_frames<const D: usize>(
    view: &View<D>,
    folder: &Path,
    begin: f64,
    domain: &Domain<D>,
    radii: &[f64],
) -> Result<Option<(StructureFactor<D>, f64)>> {
    let configurations = view.world.agree(Configurations::since(begin, folder))?;
    let Some(mut found) = StructureFactor::new(domain, radii, configurations.len()) else { return Ok(None) };
    let first = configurations.visit_own(view.world, |number, frame| {
        let centers: Vec<SVector<f64, D>> = frame.bodies.iter().map(|body| body.center).collect();
        found.add(number, &box_of(domain, &frame), &centers);
    });
    let first = first_time(view.world, view.world.agree(first)?);
    found.sum(view.world);
    Ok(Some((found, first)).filter(|_| first.is_finite()))
}
