//! `pairs.csv` and `pairs.json`: the pair distribution of a run, over its frames once it has ended, or of an instant.

use std::path::{Path, PathBuf};

use crate::{
    error::Result,
    geometry::{Ball, Domain},
    linalg::ROUNDING,
    observe::{FrameBody, PairCounts, PairDistribution, Shear},
    output::{FrameFile, MeanViscosity, PairSummary, Summary, pair_files},
    parallel::World,
    run::{Output, View},
};

/// Part of a run without a steady viscosity that is left out.
const START_UP: f64 = 0.5;

/// Measures pairs at the end.
pub struct PairFiles {
    /// Where the files go, and where the frames are.
    pub folder: PathBuf,
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
                counts.add(bodies.domain.time(), &balls);
                counts.distribution().map(|distribution| (distribution, 0.0))
            }
            (None, None) => None,
        };
        if view.world.max(f64::from(distribution.is_some())) == 0.0 {
            return Ok(Vec::new());
        }
        let nothing = || ["pairs.csv", "pairs.json", "pairs.svg"].map(|name| (name, Vec::new()));
        let files = distribution.as_ref().map_or_else(nothing, |(found, _)| pair_files(view.scene.shown_title(), found));
        summary.pairs = distribution.map(|(found, from_time)| PairSummary {
            coordination: found.coordination,
            configurations: found.configurations,
            from_time,
        });
        files.iter().map(|(name, bytes)| view.write_file(&self.folder, name, bytes)).collect()
    }
}

/// The time from which frames of a run until `end` count: where the steady part of its viscosity begins, or else its second half, but for rounding.
/// Collective.
pub fn steady_from<const D: usize>(world: &World, shear: Option<&Shear<D>>, end: f64, mean: Option<&MeanViscosity>) -> f64 {
    let begin = match (shear, mean) {
        (Some(shear), Some(mean)) => mean.strains[0] / shear.rate.abs(),
        _ => START_UP * end,
    };
    // the mean is known to the first rank only
    world.gather(&[begin - ROUNDING * end])[0]
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
        let first = world.agree(self.count_own(world, folder, begin, &mut counts))?;
        counts.sum(world);
        let first = -world.max(first.map_or(f64::NEG_INFINITY, |first| -first));
        Ok(counts.distribution().map(|distribution| (distribution, first)))
    }

    /// Counts the frames of this rank from a time on, and gives the first such time.
    fn count_own(&self, world: &World, folder: &Path, begin: f64, counts: &mut PairCounts<D>) -> Result<Option<f64>> {
        let mut first = None;
        for file in FrameFile::of_run(folder)?.iter().skip(world.rank()).step_by(world.size()) {
            if file.time()? < begin {
                continue;
            }
            let frame = file.read::<D>()?;
            let ball = |(body, &radius): (&FrameBody<D>, &f64)| Ball { center: body.center, radius };
            counts.add(frame.time, &frame.bodies.iter().zip(&self.radii).map(ball).collect::<Vec<_>>());
            first.get_or_insert(frame.time);
        }
        Ok(first)
    }
}
