//! What a run cost, read from its summary.

use std::path::Path;

use crate::{error::Result, experiment::summary::RunSummary, output::ParallelSummary};

/// What a run cost. Of a scene in time these are its steps without the set-up, of an instant all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Seconds of the set-up, zero of a scene in time.
    pub setup: f64,
    /// Seconds for the grid: of the coupled solver, without the blocks of the bodies.
    pub grid: f64,
    /// Seconds for the bodies: their jump corrections and their blocks in the coupled solver, or all of a dry step but contacts.
    pub bodies: f64,
    /// Seconds for contacts.
    pub contacts: f64,
    /// Further seconds, which no rank shares: files.
    pub rest: f64,
    /// Steps; 1 of an instant.
    pub steps: usize,
    /// Iterations of all solves; none in a dry run.
    pub iterations: usize,
    /// Contacts that were solved for in all steps.
    pub active_contacts: f64,
    /// Contacts of the largest island that one rank solved, in all steps.
    pub island: f64,
    /// Shares of the ranks, and what they sent.
    pub parallel: ParallelSummary,
}

impl Measurement {
    /// Of the run that wrote a summary.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(path: &Path) -> Result<Measurement> {
        let summary = RunSummary::read(path)?;
        // a run in time tells only of its last solve which part the bodies took
        let last = summary.number("/solver/solve_seconds");
        let part = if last > 0.0 { summary.number("/solver/body_seconds") / last } else { 0.0 };
        let section = if summary.in_time() { "motion" } else { "solver" };
        let number = |name: &str| summary.number(&format!("/{section}/{name}"));
        let (assembly, solve) = (number("assembly_seconds"), number("solve_seconds"));
        let (grid, contacts) = (solve * (1.0 - part), number("contact_seconds"));
        let (setup, others) = match summary.in_time() {
            true => (0.0, (number("seconds") - assembly - solve - contacts).max(0.0)),
            false => (number("setup_seconds"), 0.0),
        };
        let rest = if solve > 0.0 { others } else { others.min(number("output_seconds")) };
        Ok(Measurement {
            setup,
            grid,
            bodies: assembly + solve * part + others - rest,
            contacts,
            rest,
            steps: summary.get::<usize>("/steps").map_or(1, |steps| steps.max(1)),
            iterations: number("iterations") as usize,
            active_contacts: number("contacts"),
            island: number("island_contacts"),
            parallel: summary.get("/parallel").unwrap_or_default(),
        })
    }

    /// How often ranks exchange what they have: in each iteration, or in each step of a run without any.
    pub fn exchanges(&self) -> f64 {
        (if self.iterations > 0 { self.iterations } else { self.steps }) as f64
    }

    /// Seconds of the instant, or of all steps.
    pub fn all_seconds(&self) -> f64 {
        self.setup + self.grid + self.bodies + self.contacts + self.rest
    }

    /// Seconds of the instant, or of a step.
    pub fn seconds(&self) -> f64 {
        self.all_seconds() / self.steps as f64
    }
}
