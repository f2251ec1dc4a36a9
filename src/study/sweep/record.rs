//! What is kept of a run of a sweep.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{reading::Reading, vary::Assignment};
use crate::{
    experiment::{self, record::RunOutcome},
    output::checksum_of,
};

/// Most signs of the name of a folder, before what tells it apart.
const LONGEST_NAME: usize = 120;

/// A run: what is set in the scene, and the seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepSetting {
    /// Keys with their values.
    pub point: Vec<Assignment>,
    /// The seed; nothing where it is one of the keys.
    pub seed: Option<u64>,
}

/// A setting and what came of it.
pub type SweepRecord = experiment::record::Record<SweepSetting, Measured>;

/// A run to its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The quantities, in the order of the command line; nothing for those that the run does not have.
    pub readings: Vec<Option<Reading>>,
    /// Part of the box that bodies fill, as they were placed.
    pub fraction: f64,
    /// Seconds of set-up and solves.
    pub seconds: f64,
    /// What is kept of the run, from the folder of the sweep; nothing if nothing is.
    pub folder: Option<String>,
}

impl SweepSetting {
    /// The overrides that make the scene this one.
    pub fn overrides(&self) -> Vec<String> {
        let seed = self.seed.map(|seed| format!("seed={seed}"));
        self.point.iter().map(|(key, value)| format!("{key}={value}")).chain(seed).collect()
    }

    /// A name for a folder that no other setting has.
    pub fn folder_name(&self) -> String {
        let plain = self.overrides().join(",");
        let keep = |sign: char| if sign.is_ascii_alphanumeric() || ".,=+-".contains(sign) { sign } else { '_' };
        let name: String = plain.chars().map(keep).take(LONGEST_NAME).collect();
        if name == plain { name } else { format!("{name}-{:016x}", checksum_of(&plain)) }
    }
}

impl fmt::Display for SweepSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let keys = self.point.iter().map(|(key, value)| format!("{key} = {value}"));
        let seed = self.seed.map(|seed| format!("seed {seed}"));
        write!(f, "{}", keys.chain(seed).collect::<Vec<_>>().join(", "))
    }
}

impl fmt::Display for SweepRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.outcome {
            RunOutcome::Measured(Measured { readings, seconds, .. }) => {
                let values = readings
                    .iter()
                    .map(|reading| reading.map_or("-".into(), |reading| format!("{:.6}", reading.value)))
                    .collect::<Vec<_>>()
                    .join(", ");
                write!(f, "{}: {values} in {seconds:.1} s", self.setting)
            }
            RunOutcome::Failed(reason) => write!(f, "{}: {reason}", self.setting),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_settings_have_names_of_their_own() {
        let name = |value: &str, seed| SweepSetting { point: vec![("a.0.b".into(), value.into())], seed }.folder_name();
        assert_eq!(name("0.1", Some(3)), "a.0.b=0.1,seed=3");
        let odd = ["[0, -1]", "(0, -1)", "../../x", &"9".repeat(300), &"9".repeat(301)].map(|value| name(value, None));
        assert!(odd.iter().all(|name| name.len() < 140 && !name.contains('/') && !name.starts_with('.')), "{odd:?}");
        assert!((1..odd.len()).all(|place| !odd[..place].contains(&odd[place])), "{odd:?}");
    }
}
