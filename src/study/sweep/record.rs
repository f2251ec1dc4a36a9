//! What is kept of a run of a sweep.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::vary::Assignment;
use crate::study::store::Recorded;

/// A run: what is set in the scene, and the seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Keys with their values.
    pub point: Vec<Assignment>,
    /// The seed; nothing where it is one of the keys.
    pub seed: Option<u64>,
}

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
    pub value: f64,
    /// Half the width of its 95 % interval over the time of the run, where it is known.
    pub half_width: Option<f64>,
    /// What to bear in mind.
    pub remark: Option<String>,
    /// Seconds of set-up and solves.
    pub seconds: f64,
}

impl Setting {
    /// The overrides that make the scene this one.
    pub fn overrides(&self) -> Vec<String> {
        let seed = self.seed.map(|seed| format!("seed={seed}"));
        self.point.iter().map(|(key, value)| format!("{key}={value}")).chain(seed).collect()
    }
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

impl Recorded for Record {
    type Setting = Setting;

    fn setting(&self) -> &Setting {
        &self.setting
    }

    /// Failures are tried again.
    fn lasting(&self) -> bool {
        self.measured().is_some()
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let keys = self.point.iter().map(|(key, value)| format!("{key} = {value}"));
        let seed = self.seed.map(|seed| format!("seed {seed}"));
        write!(f, "{}", keys.chain(seed).collect::<Vec<_>>().join(", "))
    }
}

impl fmt::Display for Record {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.outcome {
            Outcome::Measured(Measured { value, seconds, .. }) => write!(f, "{}: {value:.6} in {seconds:.1} s", self.setting),
            Outcome::Failed(reason) => write!(f, "{}: {reason}", self.setting),
        }
    }
}
