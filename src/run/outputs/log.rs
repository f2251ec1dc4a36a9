//! `run.log`: how far a run has come, a line a minute or a percent, whichever is rarer; a run that goes on adds to it.

use std::{
    fs::{File, OpenOptions},
    io::Write,
    path::Path,
    time::{Instant, SystemTime},
};

use crate::{
    error::{Error, Result},
    motion::StepReport,
    output::{LOG, MeanViscosity, Summary, date, duration, note},
    parallel::{Machine, World},
    run::{Output, View, command},
    setup::State,
};

/// Seconds between lines, at least.
const MINUTE: f64 = 60.0;
/// Part of the run between lines, at least.
const PERCENT: f64 = 0.01;

/// The log of a run.
pub struct RunLog {
    /// On the first rank, as long as it can be written.
    file: Option<File>,
    start: Instant,
    last: Instant,
    /// Time where this program began and where it ends.
    times: [f64; 2],
    /// The time of the last line.
    shown: f64,
}

/// Adds a line with the date to the log of a run in a folder; on one rank.
pub fn add_to_log_local(folder: &Path, text: &str) {
    // the run goes on without a line that cannot be written
    let _ = OpenOptions::new().append(true).open(folder.join(LOG)).and_then(|mut file| write_line(&mut file, text));
}

fn write_line(file: &mut File, text: &str) -> std::io::Result<()> {
    writeln!(file, "{}  {text}", date(SystemTime::now()))
}

impl RunLog {
    /// Opens it, and says that a run begins, or goes on from a time, towards its end. Collective.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(world: &World, folder: &Path, begin: Option<f64>, end: f64) -> Result<RunLog> {
        let path = folder.join(LOG);
        let failed = |source| Error::File { path: path.clone(), source };
        let file = world.on_first_rank(|| OpenOptions::new().create(true).append(true).open(&path).map(Some).map_err(failed))?;
        let from = begin.unwrap_or(0.0);
        let (start, times) = (Instant::now(), [from, end]);
        let mut log = RunLog { file, start, last: start, times, shown: from };
        let begun = begin.map_or("started".to_owned(), |time| format!("goes on from time {time}"));
        let (version, ranks, host) = (env!("CARGO_PKG_VERSION"), world.size(), Machine::local().name);
        log.line(&format!("{begun} by turbid {version} on {ranks} rank{} of {host}: {}", if ranks == 1 { "" } else { "s" }, command()));
        Ok(log)
    }

    /// Says that the run has ended.
    pub fn end(&mut self, ending: &str) {
        let since = if self.times[0] > 0.0 { "went on" } else { "started" };
        self.line(&format!("{ending}, {} after it {since}", duration(self.seconds())));
    }

    /// Adds a line with the date; a log that cannot be written is given up.
    fn line(&mut self, text: &str) {
        let Some(file) = &mut self.file else { return };
        if let Err(error) = write_line(file, text) {
            note(&format!("turbid: {LOG} cannot be written any more ({error}); the run goes on without it"));
            self.file = None;
        }
    }

    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Says how far the run is, if it is time to.
    fn progress<const D: usize>(&mut self, state: &State<D>, mean: Option<&MeanViscosity>) {
        let [begin, end] = self.times;
        let gone = self.last.elapsed().as_secs_f64() >= MINUTE && state.time - self.shown >= PERCENT * end;
        if self.file.is_none() || !gone {
            return;
        }
        (self.last, self.shown) = (Instant::now(), state.time);
        let left = self.seconds() * (end - state.time) / (state.time - begin);
        let mean = mean.map_or(String::new(), |mean| format!(", mean viscosity {:.4} ± {:.1e}", mean.relative, mean.half_width()));
        let (part, time, step) = (100.0 * state.time / end, state.time, state.steps);
        self.line(&format!("time {time:.6} of {end} ({part:.1} %), step {step}, {} left{mean}", duration(left)));
    }
}

impl<const D: usize> Output<D> for RunLog {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        if let Some(motion) = &view.motion {
            let halved = motion.statistics.last().filter(|last| last.halvings > 0);
            if let Some(StepReport { length, halvings, .. }) = halved {
                let (time, times) = (motion.state().time, if *halvings == 1 { "once" } else { "several times" });
                self.line(&format!("the step to time {time:.6} failed and was halved {times}, to {length:.3e}"));
            }
            self.progress(motion.state(), view.history.mean());
        }
        Ok(())
    }

    fn interrupted(&mut self, error: &Error) {
        self.line(&format!("broke off after {}: {}", duration(self.seconds()), error.to_string().replace('\n', "; ")));
    }

    fn finish(&mut self, view: &View<D>, summary: &mut Summary) -> Result<Vec<String>> {
        let ending = match &view.motion {
            Some(_) => format!("ended at time {} after {} steps", summary.time, summary.steps),
            None => "ended".to_owned(),
        };
        self.end(&ending);
        Ok(vec![LOG.to_owned()])
    }
}
