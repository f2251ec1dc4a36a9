//! `pairs.csv` and `pairs.json`: the pair distribution of a run, over its frames once it has ended, or of an instant.

use std::path::{Path, PathBuf};

use super::configurations::{Configurations, box_of, first_time, steady_from};
use crate::run::outputs::context::{Context, Wanted};
use crate::{
    error::Result,
    geometry::{Ball, Domain},
    observe::{FrameBody, PairCounts, PairDistribution, Shear},
    output::{MeanViscosity, PAIR_FILES, PairSummary, Summary, pair_files},
    parallel::World,
    run::{Output, View},
};

/// Measures pairs at the end.
pub struct PairFiles {
    /// Where the files go, and where the frames are.
    pub folder: PathBuf,
}

/// With `output.pairs`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.pairs, |context| PairFiles { folder: context.path() })
}

/// The bodies that are looked at.
struct PairBodies<'a, const D: usize> {
    domain: &'a Domain<D>,
    radii: Vec<f64>,
    shear: Option<Shear<D>>,
}

impl<const D: usize> Output<D> for PairFiles {
    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let setup = view.flow.map(|flow| flow.solver.setup());
        let shear = setup.and_then(|setup| Shear::of(&setup.domain, &setup.drive));
        let distribution = match (&view.motion, setup) {
            (Some(motion), _) => {
                let radii = motion.simulation.whole_balls().iter().map(|ball| ball.radius).collect();
                let bodies = PairBodies { domain: motion.domain(), radii, shear };
                bodies.over_frames(view.world, &self.folder, motion.state().time, view.history.mean())?
            }
            (None, Some(setup)) => {
                let balls: Vec<Ball<D>> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
                let bodies = PairBodies { domain: &setup.domain, radii: balls.iter().map(|ball| ball.radius).collect(), shear };
                let mut counts = bodies.counts();
                counts.add(bodies.domain, &balls);
                counts.distribution().map(|distribution| (distribution, 0.0))
            }
            (None, None) => None,
        };
        if view.world.max(f64::from(distribution.is_some())) == 0.0 {
            return Ok(Vec::new());
        }
        let nothing = || PAIR_FILES.map(|name| (name, Vec::new()));
        let files = distribution.as_ref().map_or_else(nothing, |(found, _)| pair_files(view.scene.shown_title(), found));
        summary.pairs = distribution.map(|(found, from_time)| PairSummary {
            coordination: found.coordination,
            configurations: found.configurations,
            from_time,
        });
        files.iter().map(|(name, bytes)| view.write_file(&self.folder, name, bytes)).collect()
    }
}

impl<const D: usize> PairBodies<'_, D> {
    fn counts(&self) -> PairCounts<'_, D> {
        PairCounts::new(self.domain, &self.radii, self.shear)
    }

    /// Over the frames of a run until `end`: those of the steady part of its viscosity, or else of its second half; and the time of the first.
    /// Ranks read frames in turn, one at a time. Collective.
    fn over_frames(&self, world: &World, folder: &Path, end: f64, mean: Option<&MeanViscosity>) -> Result<Option<(PairDistribution, f64)>> {
        let begin = steady_from(world, self.shear.as_ref(), end, mean);
        let mut counts = self.counts();
        let configurations = world.agree(Configurations::since(begin, folder))?;
        let first = configurations.visit_own(world, |_, frame| {
            let ball = |(body, &radius): (&FrameBody<D>, &f64)| Ball { center: body.center, radius };
            let balls: Vec<Ball<D>> = frame.bodies.iter().zip(&self.radii).map(ball).collect();
            counts.add(&box_of(self.domain, &frame), &balls);
        });
        let first = first_time(world, world.agree(first)?);
        counts.sum(world);
        Ok(counts.distribution().map(|distribution| (distribution, first)))
    }
}
