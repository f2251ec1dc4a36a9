//! What a run cost, read from its summary.

use std::{fs, path::Path};

use serde::Deserialize;

use crate::{
    error::{Error, Result},
    output::ParallelSummary,
};

/// What a run cost. Of a scene in time these are its steps without the set-up, of an instant all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Seconds of the set-up, zero of a scene in time.
    pub setup: f64,
    /// Seconds for the grid: of the coupled solver, without the blocks of the bodies.
    pub grid: f64,
    /// Seconds for the bodies: their jump corrections, and their blocks in the coupled solver.
    pub bodies: f64,
    /// Seconds for contacts, which grow with the bodies of all ranks.
    pub contacts: f64,
    /// Further seconds, which no rank shares: files.
    pub rest: f64,
    /// Steps; 1 of an instant.
    pub steps: usize,
    /// Iterations of all solves.
    pub iterations: usize,
    /// Shares of the ranks, and what they sent.
    pub parallel: ParallelSummary,
}

#[derive(Deserialize)]
struct Summary {
    steps: usize,
    solver: Solver,
    motion: Option<Motion>,
    parallel: ParallelSummary,
}

#[derive(Deserialize)]
struct Solver {
    iterations: usize,
    setup_seconds: f64,
    assembly_seconds: f64,
    solve_seconds: f64,
    body_seconds: f64,
}

#[derive(Deserialize)]
struct Motion {
    iterations: usize,
    seconds: f64,
    assembly_seconds: f64,
    solve_seconds: f64,
    contact_seconds: f64,
}

impl Measurement {
    /// Of the run that wrote a summary.
    ///
    /// # Errors
    /// It cannot be read, or is that of a dry run.
    pub fn read(path: &Path) -> Result<Measurement> {
        let unreadable = |source| Error::File { path: path.to_owned(), source };
        let text = fs::read_to_string(path).map_err(unreadable)?;
        let summary = serde_json::from_str(&text).map_err(|error| unreadable(error.into()))?;
        Ok(Measurement::of(summary))
    }

    fn of(summary: Summary) -> Measurement {
        let Summary { steps, solver, motion, parallel } = summary;
        // a run in time tells only of its last solve which part the bodies took
        let part = if solver.solve_seconds > 0.0 { solver.body_seconds / solver.solve_seconds } else { 0.0 };
        let split = |assembly: f64, solve: f64| (solve * (1.0 - part), assembly + solve * part);
        match motion {
            None => {
                let (grid, bodies) = split(solver.assembly_seconds, solver.solve_seconds);
                Measurement {
                    setup: solver.setup_seconds,
                    grid,
                    bodies,
                    contacts: 0.0,
                    rest: 0.0,
                    steps: 1,
                    iterations: solver.iterations,
                    parallel,
                }
            }
            Some(motion) => {
                let (grid, bodies) = split(motion.assembly_seconds, motion.solve_seconds);
                let contacts = motion.contact_seconds;
                let rest = (motion.seconds - grid - bodies - contacts).max(0.0);
                Measurement { setup: 0.0, grid, bodies, contacts, rest, steps: steps.max(1), iterations: motion.iterations, parallel }
            }
        }
    }

    /// Seconds of the instant, or of a step.
    pub fn seconds(&self) -> f64 {
        (self.setup + self.grid + self.bodies + self.contacts + self.rest) / self.steps as f64
    }
}
