//! `report.html`: the run on one page, renewed once a minute of wall time and made complete at the end.

use std::{
    path::{Path, PathBuf},
    time::{Instant, SystemTime},
};

use crate::{
    error::{Error, Result},
    output::{Answer, MeanViscosity, REPORT, Standing, Summary, TooShort, date, duration, note, write_whole},
    parallel::World,
    run::{Evaluated, Output, page::PageOfRun},
    scene::Scene,
};

/// Seconds of wall time between pages, at least.
const MINUTE: f64 = 60.0;
/// How much longer than writing a page the run goes on before the next, at least.
const PATIENCE: f64 = 50.0;

/// The page of a run.
pub struct ReportFile {
    /// On the first rank.
    page: Option<PageOfRun>,
    folder: PathBuf,
    written: Option<(Instant, f64)>,
    /// How far the run is, and what it answers so far.
    so_far: (String, Vec<Answer>, Option<MeanViscosity>),
}

impl ReportFile {
    /// For a scene's run in a folder.
    pub fn new(world: &World, scene: &Scene, folder: &Path) -> ReportFile {
        let page = (world.rank() == 0).then(|| PageOfRun::new(scene, folder, world.size()));
        ReportFile { page, folder: folder.to_owned(), written: None, so_far: (String::new(), Vec::new(), None) }
    }

    fn due(&self) -> bool {
        self.written.is_none_or(|(when, took)| when.elapsed().as_secs_f64() > MINUTE.max(PATIENCE * took))
    }

    /// Takes note of where the run is.
    fn look<const D: usize>(&mut self, seen: &Evaluated<D>) {
        let Some(motion) = &seen.motion else { return };
        let (state, end) = (motion.state(), seen.scene.end());
        let so_far = format!("time {:.6} of {end}, step {}, after {}", state.time, state.steps, duration(motion.statistics.motion().seconds));
        let mean = seen.history.mean().copied();
        self.so_far = (so_far, answers_so_far(seen, mean.as_ref()), mean);
    }

    /// Writes the page of a run that has not ended; one that cannot be written stops no run.
    fn renew(&mut self, standing: Standing) {
        let Some(page) = &self.page else { return };
        let start = Instant::now();
        let (so_far, answers, mean) = self.so_far.clone();
        let written = format!("{so_far}{}written {}", if so_far.is_empty() { "" } else { "; " }, date(SystemTime::now()));
        let html = page.unfinished(standing, written, answers, mean).html();
        if let Err(error) = write_whole(&self.folder.join(REPORT), html.as_bytes()) {
            note(&format!("turbid: {error}; the run goes on"));
        }
        self.written = Some((Instant::now(), start.elapsed().as_secs_f64()));
    }
}

/// What is known on the way without asking other ranks.
fn answers_so_far<const D: usize>(seen: &Evaluated<D>, mean: Option<&MeanViscosity>) -> Vec<Answer> {
    let Some(viscosity) = &seen.viscosity else { return Vec::new() };
    let value = match mean {
        Some(mean) => format!("{:.4} ± {:.1e} so far", mean.relative, mean.half_width()),
        None => TooShort::of(seen.history.points()).text(),
    };
    vec![
        Answer { name: "mean viscosity", value },
        Answer { name: "relative viscosity", value: format!("{:.4} at this instant", viscosity.relative()) },
    ]
}

impl<const D: usize> Output<D> for ReportFile {
    fn write(&mut self, seen: &Evaluated<D>) -> Result<()> {
        let last = seen.motion.is_none_or(|motion| motion.last);
        if self.page.is_some() && !last {
            if self.due() {
                self.look(seen);
                self.renew(Standing::UnderWay);
            }
        }
        Ok(())
    }

    fn interrupted(&mut self, error: &Error) {
        self.renew(Standing::Broken(error.to_string()));
    }

    fn finish(&mut self, seen: &Evaluated<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let html = self.page.as_ref().map_or(String::new(), |page| page.ended(summary, seen.history.mean().copied()).html());
        Ok(vec![seen.write_file(&self.folder, REPORT, html.as_bytes())?])
    }
}
