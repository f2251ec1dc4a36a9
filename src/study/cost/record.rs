//! What is kept of a run: its setting, the quantity, what it cost.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{facts::Facts, quantity::Quantity, setting::Setting};
use crate::error::{Error, Result};

/// A setting and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The setting.
    pub setting: Setting,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of a setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A run to its end.
    Measured(Measured),
    /// Why there is none.
    Failed(String),
}

/// A run to its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The quantity.
    pub values: Vec<f64>,
    /// Spacing of the grid as it was.
    pub spacing: f64,
    /// Highest order of the surface modes, where the method has any.
    pub modes: Option<usize>,
    /// Unknowns of grid and surfaces.
    pub unknowns: f64,
    /// Iterations of a solve, in the mean.
    pub iterations: f64,
    /// Seconds of matrices, hierarchies and, at an instant, jump corrections.
    pub setup_seconds: f64,
    /// Seconds of the solve, or of all steps.
    pub solve_seconds: f64,
    /// Steps; zero at an instant.
    pub steps: usize,
    /// Bytes of all ranks at their peak.
    pub memory_bytes: f64,
    /// A faster inverse of the fluid, and the seconds of the last solve with it over those it took.
    pub faster: Option<(String, f64)>,
    /// Seconds by the clock, start of the program and repetitions included.
    pub wall_seconds: f64,
}

impl Record {
    /// The run, if it came to its end.
    pub fn measured(&self) -> Option<&Measured> {
        match &self.outcome {
            Outcome::Measured(measured) => Some(measured),
            Outcome::Failed(_) => None,
        }
    }
}

impl Measured {
    /// Of a run that left a summary there; seconds by the clock are left to whoever watched it.
    ///
    /// # Errors
    /// The summary cannot be read or does not tell the quantity.
    pub fn read(path: &Path, (setting, modes): (&Setting, Option<usize>), quantity: &Quantity, facts: &Facts) -> Result<Measured> {
        let unreadable = |source| Error::File { path: path.to_owned(), source };
        let text = fs::read_to_string(path).map_err(unreadable)?;
        let summary: Value = serde_json::from_str(&text).map_err(|error| unreadable(error.into()))?;
        let values = quantity.read(&summary, path.parent().unwrap_or(Path::new("")), facts)?;
        let measured = Measured { values, modes, ..Measured::cost(&summary) };
        Ok(Measured { spacing: spacing(&summary, setting, facts), ..measured })
    }

    fn cost(summary: &Value) -> Measured {
        let (solver, motion) = (&summary["solver"], &summary["motion"]);
        let of = |section: &Value, name: &str| section[name].as_f64().unwrap_or(0.0);
        let (setup_seconds, solve_seconds, iterations) = match motion.is_null() {
            true => (of(solver, "setup_seconds") + of(solver, "assembly_seconds"), of(solver, "solve_seconds"), of(solver, "iterations")),
            false => (of(solver, "setup_seconds"), of(motion, "seconds"), of(motion, "iterations") / of(motion, "solves").max(1.0)),
        };
        let faster = &solver["faster"];
        let faster = faster["inverse"].as_str().map(|name| (name.to_owned(), of(faster, "solve_seconds") / of(solver, "solve_seconds")));
        Measured {
            values: Vec::new(),
            spacing: 0.0,
            modes: None,
            unknowns: of(solver, "grid_unknowns") + of(solver, "multiplier_unknowns"),
            iterations,
            setup_seconds,
            solve_seconds,
            steps: of(summary, "steps") as usize,
            memory_bytes: of(solver, "peak_memory_bytes"),
            faster,
            wall_seconds: 0.0,
        }
    }

    /// Seconds of everything.
    pub fn seconds(&self) -> f64 {
        self.setup_seconds + self.solve_seconds
    }

    /// Seconds of a run so many times as long.
    pub fn whole_seconds(&self, times: f64) -> f64 {
        self.setup_seconds + self.solve_seconds * times
    }
}

/// The spacing from the number of cells, because boxes hold whole ones; of a mesh that fits the bodies the one asked for.
fn spacing(summary: &Value, setting: &Setting, facts: &Facts) -> f64 {
    let asked = setting.grid.spacing(facts.radius.unwrap_or(1.0));
    let cells = summary["parallel"]["cells"]["mean"].as_f64().unwrap_or(0.0) * summary["ranks"].as_f64().unwrap_or(1.0);
    if setting.method == "fitted" || cells <= 0.0 { asked } else { (facts.volume / cells).powf(1.0 / facts.dimension as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_run_costs_is_split_into_set_up_and_solve() {
        let solver = serde_json::json!({"setup_seconds": 1.0, "assembly_seconds": 2.0, "solve_seconds": 4.0, "iterations": 7,
            "grid_unknowns": 10, "multiplier_unknowns": 5, "peak_memory_bytes": 8.0, "faster": {"inverse": "transform", "solve_seconds": 1.0}});
        let instant = Measured::cost(&serde_json::json!({"solver": solver, "steps": 0, "motion": null}));
        assert_eq!((instant.setup_seconds, instant.solve_seconds, instant.iterations, instant.unknowns), (3.0, 4.0, 7.0, 15.0));
        assert_eq!(instant.faster, Some(("transform".into(), 0.25)));
        let motion = serde_json::json!({"seconds": 30.0, "iterations": 60, "solves": 20});
        let moving = Measured::cost(&serde_json::json!({"solver": solver, "steps": 10, "motion": motion}));
        assert_eq!((moving.setup_seconds, moving.solve_seconds, moving.iterations, moving.steps), (1.0, 30.0, 3.0, 10));
        assert_eq!(moving.whole_seconds(2.0), 61.0);
    }
}
