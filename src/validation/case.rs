//! A case with a known answer.

use crate::{error::Result, petsc::Session};

/// Solves a case and measures its quantity; collective.
pub type CaseSolver = Box<dyn Fn(&Session) -> Result<f64>>;

/// A case with a known answer.
pub struct Case {
    /// What is measured.
    pub name: &'static str,
    /// Where the reference comes from.
    pub source: &'static str,
    /// Grid and modes.
    pub resolution: String,
    /// The known value.
    pub reference: f64,
    /// Largest relative error that is promised.
    pub tolerance: f64,
    /// How to get ours.
    pub solve: CaseSolver,
}

impl Case {
    /// Relative error of a value.
    pub fn error(&self, value: f64) -> f64 {
        value / self.reference - 1.0
    }
}
