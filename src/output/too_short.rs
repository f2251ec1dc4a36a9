//! Why a run has no mean viscosity.

use serde::Serialize;

use super::CurvePoint;
use crate::observe::statistics::Shortage;

/// Why a run is too short for a mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TooShort {
    /// The reason.
    pub reason: &'static str,
    /// About how much more strain it takes, at least, if that can be told.
    pub further_strain: Option<f64>,
}

impl TooShort {
    /// Of a viscosity over the strain that has no steady mean.
    pub fn of(curve: &[CurvePoint]) -> TooShort {
        let points: Vec<(f64, f64)> = curve.iter().map(|point| (point.strain.abs(), point.relative())).collect();
        let shortage = Shortage::of(&points);
        let reason = match shortage {
            Shortage::FewSamples(..) => "it has too few steps",
            Shortage::Drift(_) => "it still drifts",
            Shortage::Memory(_) => "its fluctuations last too long",
        };
        TooShort { reason, further_strain: shortage.further() }
    }

    /// In words.
    pub fn text(&self) -> String {
        let further = self.further_strain.map_or(String::new(), |strain| format!("; about {} more strain is needed, at least", digits(strain)));
        format!("none yet: the run is too short, {}{further}", self.reason)
    }
}

/// A positive number in two digits.
fn digits(number: f64) -> String {
    let places = (1.0 - number.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{number:.places$}")
}
