//! The progress of a solve on a terminal: residual, iterations, remaining time.

use std::{
    io::{IsTerminal, stderr},
    time::Instant,
};

use indicatif::{ProgressBar, ProgressStyle};

use super::{output::Output, view::View};
use crate::{
    error::Result,
    output::{MeanViscosity, Summary, with_bar},
};

/// A progress line; silent when the standard error is no terminal, and on every rank but the first.
pub struct Progress {
    line: Line,
    start: Instant,
    tolerance: f64,
}

impl Progress {
    /// A line for a solve to `tolerance`.
    pub fn new(rank: usize, tolerance: f64) -> Progress {
        Progress { line: Line::new(rank), start: Instant::now(), tolerance }
    }

    /// Shows an iteration and its relative residual.
    pub fn show(&self, iteration: usize, residual: f64) {
        let done = part_done(residual, self.tolerance);
        self.line.0.set_position((1000.0 * done) as u64);
        let left = match done {
            done if done > 0.02 => format!(", {:.0} s left", self.start.elapsed().as_secs_f64() * (1.0 - done) / done),
            _ => String::new(),
        };
        self.line.0.set_message(format!("iteration {iteration}, residual {residual:.1e} of {:.0e}{left}", self.tolerance));
    }

    /// Removes the line.
    pub fn end(&self) {
        self.line.0.finish_and_clear();
    }
}

/// A progress line of a run in time; silent as [`Progress`] is.
pub struct TimeProgress {
    line: Line,
    start: Instant,
    /// Time at the start of this run and at its end.
    times: [f64; 2],
}

impl TimeProgress {
    /// A line for a run from one time to another.
    pub fn new(rank: usize, begin: f64, end: f64) -> TimeProgress {
        TimeProgress { line: Line::new(rank), start: Instant::now(), times: [begin, end] }
    }

    /// Shows how far the run has come, and its mean viscosity once there is one.
    pub fn show(&self, time: f64, step: usize, mean: Option<&MeanViscosity>) {
        let [begin, end] = self.times;
        let done = if end > begin { ((time - begin) / (end - begin)).clamp(0.0, 1.0) } else { 1.0 };
        self.line.0.set_position((1000.0 * done) as u64);
        let elapsed = self.start.elapsed().as_secs_f64();
        let left = if done > 0.01 { format!(", {:.0} s left", elapsed * (1.0 - done) / done) } else { String::new() };
        let mean = mean.map_or(String::new(), |mean| format!(", viscosity {}", with_bar(mean.relative, mean.half_width())));
        self.line.0.set_message(format!("time {time:.4} of {end}, step {step}{mean}{left}"));
    }

    /// Removes the line.
    pub fn end(&self) {
        self.line.0.finish_and_clear();
    }
}

/// A line of a bar and a message, which goes away when it is dropped.
struct Line(ProgressBar);

impl Line {
    fn new(rank: usize) -> Line {
        let shown = rank == 0 && stderr().is_terminal();
        let line = if shown { ProgressBar::new(1000) } else { ProgressBar::hidden() };
        line.set_style(ProgressStyle::with_template("{bar:30} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar()));
        Line(line)
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// How far a residual has come on its way from 1 to the tolerance, in orders of magnitude.
fn part_done(residual: f64, tolerance: f64) -> f64 {
    if residual > 0.0 { (residual.ln() / tolerance.ln()).clamp(0.0, 1.0) } else { 1.0 }
}

impl<const D: usize> Output<D> for Progress {
    fn iterate(&mut self, iteration: usize, residual: f64) {
        self.show(iteration, residual);
    }

    fn write(&mut self, _: &View<D>) -> Result<()> {
        self.end();
        Ok(())
    }
}

impl<const D: usize> Output<D> for TimeProgress {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        if let Some(motion) = &view.motion {
            self.show(motion.state().time, motion.state().steps, view.history.mean());
        }
        Ok(())
    }

    fn finish(&mut self, _: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        self.end();
        Ok(Vec::new())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_orders_of_magnitude_is_half_of_the_work() {
        assert!((part_done(1e-3, 1e-6) - 0.5).abs() < 1e-12);
        assert_eq!(part_done(10.0, 1e-6), 0.0);
        assert_eq!(part_done(0.0, 1e-6), 1.0);
    }
}
