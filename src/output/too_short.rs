//! Why a run has no mean.

use serde::Serialize;

use crate::observe::statistics::Shortage;

/// Why a run is too short for a mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TooShort {
    /// The reason.
    pub reason: &'static str,
    /// About how much further it must go, at least, if that can be told.
    pub further: Option<f64>,
    /// What that is measured in: `strain` or `time`.
    pub unit: &'static str,
}

impl TooShort {
    /// Of what a curve over strain or time lacks for a steady mean.
    pub fn of(unit: &'static str, shortage: Shortage) -> TooShort {
        let reason = match shortage {
            Shortage::FewSamples(_) => "it has too few steps",
            Shortage::Length(_) => "its steady part is too short to estimate its fluctuations",
            Shortage::Drift(_) => "it still drifts",
            Shortage::Memory(_) => "its fluctuations last too long",
        };
        TooShort { reason, further: shortage.further(), unit }
    }

    /// In words.
    pub fn text(&self) -> String {
        let further =
            self.further.map_or(String::new(), |further| format!("; about {} more {} is needed, at least", digits(further), self.unit));
        format!("none yet: the run is too short, {}{further}", self.reason)
    }
}

/// A positive number in two digits.
fn digits(number: f64) -> String {
    let places = (1.0 - number.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{number:.places$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::statistics::steady;

    #[test]
    fn a_run_that_drifts_needs_as_much_again() {
        let curve: Vec<(f64, f64)> = (0..=200).map(|step| 0.01 * f64::from(step)).map(|time| (time, time)).collect();
        let words_of =
            |curve: &[(f64, f64)]| steady(curve, 0.0).map_err(|shortage| TooShort::of("time", shortage).text()).expect_err("no mean");
        assert_eq!(words_of(&curve), "none yet: the run is too short, it still drifts; about 2.0 more time is needed, at least");
        assert_eq!(words_of(&[]), "none yet: the run is too short, it has too few steps");
    }
}
