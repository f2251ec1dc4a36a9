//! What a run cost, read from the summary that it left.

use std::{fs, path::Path};

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::{Error, Result};

/// The summary of a run.
pub struct RunSummary(pub Value);

impl RunSummary {
    /// That of a file.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(path: &Path) -> Result<RunSummary> {
        let unreadable = |source| Error::File { path: path.to_owned(), source };
        let text = fs::read_to_string(path).map_err(unreadable)?;
        Ok(RunSummary(serde_json::from_str(&text).map_err(|error| unreadable(error.into()))?))
    }

    /// What stands at a place, such as `/viscosity/relative`; nothing if it is absent or something else.
    pub fn get<T: DeserializeOwned>(&self, place: &str) -> Option<T> {
        T::deserialize(self.0.pointer(place)?).ok()
    }

    /// The number at a place, zero if there is none.
    pub fn number(&self, place: &str) -> f64 {
        self.get(place).unwrap_or(0.0)
    }

    /// The list of numbers at a place.
    pub fn vector(&self, place: &str) -> Option<Vec<f64>> {
        numbers(self.0.pointer(place)?)
    }

    /// The mean of a vector of chosen bodies.
    pub fn mean_of_bodies(&self, name: &str, chosen: impl IntoIterator<Item = usize>) -> Option<Vec<f64>> {
        let bodies = self.0["bodies"].as_array()?;
        let vectors = chosen.into_iter().map(|body| numbers(&bodies.get(body)?[name])).collect::<Option<Vec<_>>>()?;
        let first = vectors.first()?;
        Some((0..first.len()).map(|axis| vectors.iter().map(|vector| vector[axis]).sum::<f64>() / vectors.len() as f64).collect())
    }

    /// Whether it is that of a run in time.
    pub fn in_time(&self) -> bool {
        !self.0["motion"].is_null()
    }

    /// Unknowns of grid and surfaces.
    pub fn unknowns(&self) -> f64 {
        self.number("/solver/grid_unknowns") + self.number("/solver/multiplier_unknowns")
    }

    /// Iterations of a solve, in the mean.
    pub fn iterations(&self) -> f64 {
        match self.in_time() {
            true => self.number("/motion/iterations") / self.number("/motion/solves").max(1.0),
            false => self.number("/solver/iterations"),
        }
    }

    /// Seconds of matrices, hierarchies and, at an instant, jump corrections.
    pub fn setup_seconds(&self) -> f64 {
        let assembly = if self.in_time() { 0.0 } else { self.number("/solver/assembly_seconds") };
        self.number("/solver/setup_seconds") + assembly
    }

    /// Seconds of the solve, or of all steps.
    pub fn solve_seconds(&self) -> f64 {
        self.number(if self.in_time() { "/motion/seconds" } else { "/solver/solve_seconds" })
    }

    /// A faster inverse of the fluid that the run could have taken.
    pub fn faster(&self) -> Option<String> {
        self.get("/solver/faster")
    }

    /// Bytes of all ranks at their peak.
    pub fn memory_bytes(&self) -> f64 {
        self.number("/solver/peak_memory_bytes")
    }
}

/// The numbers of a list.
pub fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_run_costs_is_split_into_set_up_and_solve() {
        let solver = serde_json::json!({"setup_seconds": 1.0, "assembly_seconds": 2.0, "solve_seconds": 4.0, "iterations": 7,
            "grid_unknowns": 10, "multiplier_unknowns": 5, "peak_memory_bytes": 8.0, "faster": "transform"});
        let instant = RunSummary(serde_json::json!({"solver": solver, "steps": 0, "motion": null}));
        assert_eq!((instant.setup_seconds(), instant.solve_seconds(), instant.iterations(), instant.unknowns()), (3.0, 4.0, 7.0, 15.0));
        assert_eq!(instant.faster(), Some("transform".into()));
        let motion = serde_json::json!({"seconds": 30.0, "iterations": 60, "solves": 20});
        let moving = RunSummary(serde_json::json!({"solver": solver, "steps": 10, "motion": motion}));
        assert_eq!((moving.setup_seconds(), moving.solve_seconds(), moving.iterations(), moving.get("/steps")), (1.0, 30.0, 3.0, Some(10)));
    }
}
