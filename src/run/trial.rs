//! The first steps of a run, taken to see what the whole one takes.

use std::{fs, path::Path, time::Instant};

use super::{
    folder::{NewRun, RunFolder},
    options::Options,
    run::{Run, complete},
};
use crate::{
    error::{Error, Result},
    parallel::processor_seconds,
    petsc::Session,
    scene::Scene,
};

/// Steps at most, at least, and seconds on a processor after which no further one is taken: as many steps on a machine that others use too.
const MOST: usize = 400;
const FEWEST: usize = 4;
const SECONDS: f64 = 2.0;

/// What a run took whose first steps were taken, with all that it writes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Seconds until the first state was written; of a scene at an instant, of the whole run.
    pub start: f64,
    /// Steps taken.
    pub taken: usize,
    /// Seconds of these.
    pub seconds: f64,
    /// Mean seconds of the later half of them.
    pub step: f64,
    /// Steps that are left, if they are as long as the later half of these were on average.
    pub left: f64,
}

impl Trial {
    /// Runs a scene of dimension `D` for a while; what the run ends with, if it does not come so far. It leaves no files behind. Collective.
    ///
    /// # Errors
    /// PETSc fails, or files cannot be written.
    pub fn of<const D: usize>(session: &Session, scene: &Scene) -> Result<std::result::Result<Trial, String>> {
        let world = session.world();
        let process = world.gather(&[std::process::id()])[0];
        let path = std::env::temp_dir().join(format!("turbid-plan-{process}"));
        let trial = trial::<D>(session, scene, &path);
        world.on_first_rank(|| {
            // a run that was refused has made no folder
            let _ = fs::remove_dir_all(&path);
            Ok(())
        })?;
        match trial {
            Ok(trial) => Ok(Ok(trial)),
            Err(
                error @ (Error::Refused(_)
                | Error::Diverged(_)
                | Error::StepTooLong { .. }
                | Error::CourantExceeded(_)
                | Error::Contact { .. }),
            ) => Ok(Err(error.to_string())),
            Err(error) => Err(error),
        }
    }

    /// Seconds of the whole run.
    pub fn total(&self) -> f64 {
        self.start + self.seconds + self.left * self.step
    }
}

fn trial<const D: usize>(session: &Session, scene: &Scene, path: &Path) -> Result<Trial> {
    let (begin, world) = (Instant::now(), session.world());
    let passed = || world.max(begin.elapsed().as_secs_f64());
    let before = processor_seconds();
    let worked = || {
        let worked = processor_seconds().zip(before).map(|(now, before)| now - before);
        world.max(worked.unwrap_or_else(|| begin.elapsed().as_secs_f64()))
    };
    let folder = Some(RunFolder::to_begin(world, path, NewRun { scene, scene_file: None, overwrite: true })?);
    if scene.scalar() || scene.time.is_none() {
        complete::<D>(session, scene, folder, Options::default())?;
        return Ok(Trial { start: passed(), taken: 0, seconds: 0.0, step: 0.0, left: 0.0 });
    }
    let mut run = Run::<D>::start(session, scene, folder, Options::default())?;
    let mut goes_on = run.advance()?;
    let time = |run: &Run<D>| run.state().map_or(0.0, |state| state.time);
    // at the end of each step, the time and the seconds so far
    let mut ends = vec![(time(&run), passed())];
    while goes_on && ends.len() <= MOST && (ends.len() <= FEWEST || worked() < SECONDS) {
        goes_on = run.advance()?;
        ends.push((time(&run), passed()));
    }
    let (first, middle, last) = (ends[0], ends[ends.len() / 2], ends[ends.len() - 1]);
    let later = (ends.len() - 1 - ends.len() / 2).max(1) as f64;
    let left = if goes_on { (scene.end() - last.0) / (last.0 - middle.0) * later } else { 0.0 };
    Ok(Trial { start: first.1, taken: ends.len() - 1, seconds: last.1 - first.1, step: (last.1 - middle.1) / later, left })
}
