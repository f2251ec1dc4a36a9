//! `report.html`: the run on one page, renewed once a minute of wall time and made complete at the end.

use std::{
    path::{Path, PathBuf},
    time::{Instant, SystemTime},
};

use super::context::{Context, Wanted};
use crate::{
    error::{Error, Result},
    output::{Answer, MeanViscosity, REPORT, Standing, Summary, date, duration, note, viscosity_too_short, write_whole},
    parallel::World,
    run::{Output, View, page::PageOfRun},
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
    /// How far the run is.
    reached: String,
    /// What it answers so far.
    answers: (Vec<Answer>, Option<MeanViscosity>),
}

/// With `output.report`.
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    context.when(context.scene.output.report, |context| ReportFile::new(context.world, context.scene, context.folder))
}

impl ReportFile {
    /// For a scene's run in a folder.
    fn new(world: &World, scene: &Scene, folder: &Path) -> ReportFile {
        let page = (world.rank() == 0).then(|| PageOfRun::new(scene, folder, world.size()));
        ReportFile { page, folder: folder.to_owned(), written: None, reached: String::new(), answers: (Vec::new(), None) }
    }

    fn due(&self) -> bool {
        self.written.is_none_or(|(when, took)| when.elapsed().as_secs_f64() > MINUTE.max(PATIENCE * took))
    }

    /// Writes the page of a run that has not ended; one that cannot be written stops no run.
    fn renew(&mut self, standing: Standing) {
        let Some(page) = &self.page else { return };
        let start = Instant::now();
        let (answers, mean) = self.answers.clone();
        let written = format!("{}; written {}", self.reached, date(SystemTime::now()));
        let html = page.unfinished(standing, written, answers, mean).html();
        if let Err(error) = write_whole(&self.folder.join(REPORT), html.as_bytes()) {
            note(&format!("turbid: {error}; the run goes on"));
        }
        self.written = Some((Instant::now(), start.elapsed().as_secs_f64()));
    }
}

/// What is known on the way without asking other ranks.
fn answers_so_far<const D: usize>(view: &View<D>, mean: Option<&MeanViscosity>) -> Vec<Answer> {
    let Some(viscosity) = &view.viscosity else { return Vec::new() };
    if view.scene.changing_shear().is_some() {
        return vec![Answer { name: "shear stress", value: format!("{:.5} at this instant", viscosity.shear_stress) }];
    }
    let value = match mean {
        Some(mean) => format!("{:.4} ± {:.1e} so far", mean.relative, mean.half_width()),
        None => viscosity_too_short(view.history.points()).map_or(String::new(), |short| short.text()),
    };
    vec![
        Answer { name: "mean viscosity", value },
        Answer { name: "relative viscosity", value: format!("{:.4} at this instant", viscosity.relative()) },
    ]
}

impl<const D: usize> Output<D> for ReportFile {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let Some(motion) = view.motion.filter(|_| self.page.is_some()) else { return Ok(()) };
        let (state, end) = (motion.state(), view.scene.end());
        self.reached =
            format!("time {:.6} of {end}, step {}, after {}", state.time, state.steps, duration(motion.statistics.motion().seconds));
        if !motion.last && self.due() {
            let mean = view.history.mean().copied();
            self.answers = (answers_so_far(view, mean.as_ref()), mean);
            self.renew(Standing::UnderWay);
        }
        Ok(())
    }

    fn interrupted(&mut self, error: &Error) {
        self.renew(Standing::Broken(error.to_string()));
    }

    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let html = self.page.as_ref().map_or(String::new(), |page| page.ended(summary, view.history.mean().copied()).html());
        Ok(vec![view.write_file(&self.folder, REPORT, html.as_bytes())?])
    }
}
