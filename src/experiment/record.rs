//! A setting and what came of its run.

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::store::Recorded;

/// A setting and what came of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record<S, M> {
    /// The setting.
    pub setting: S,
    /// What came of it.
    pub outcome: RunOutcome<M>,
}

/// What came of a setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunOutcome<M> {
    /// A run to its end.
    Measured(M),
    /// Why there is none.
    Failed(String),
}

impl<S, M> Record<S, M> {
    /// The run, if it came to its end.
    pub fn measured(&self) -> Option<&M> {
        match &self.outcome {
            RunOutcome::Measured(measured) => Some(measured),
            RunOutcome::Failed(_) => None,
        }
    }

    /// Why there is no run, if there is none.
    pub fn failure(&self) -> Option<&str> {
        match &self.outcome {
            RunOutcome::Measured(_) => None,
            RunOutcome::Failed(reason) => Some(reason),
        }
    }
}

impl<S, M> Recorded for Record<S, M>
where
    S: PartialEq + Serialize + DeserializeOwned,
    M: Serialize + DeserializeOwned,
{
    type Setting = S;

    fn setting(&self) -> &S {
        &self.setting
    }

    /// Failures are tried again.
    fn lasting(&self) -> bool {
        self.measured().is_some()
    }
}
