//! Which parameter dominates the error of a setting.

use serde::Serialize;

use super::setting::CostSetting;

/// A parameter that was changed.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ParameterChange {
    /// Which.
    pub name: &'static str,
    /// To where.
    pub to: String,
    /// Relative change of the quantity, with its sign where that is one value.
    pub change: Option<f64>,
    /// Why there is none, or where it comes from.
    pub remark: Option<String>,
    /// Relative error that is left, once there is a reference.
    pub error: Option<f64>,
    /// Seconds of the run.
    pub seconds: Option<f64>,
    /// Change of each value.
    #[serde(skip)]
    pub changes: Vec<f64>,
    /// The values.
    #[serde(skip)]
    pub values: Vec<f64>,
}

/// A setting whose parameters were changed one at a time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The setting.
    pub at: CostSetting,
    /// Its parameters.
    #[serde(rename = "knobs")]
    pub parameters: Vec<ParameterChange>,
}

impl Sensitivity {
    /// The parameter that changes the quantity most.
    pub fn dominating(&self) -> Option<&ParameterChange> {
        let sized = self.parameters.iter().filter(|parameter| parameter.change.is_some_and(|change| change != 0.0));
        sized.max_by(|one, two| one.change.map(f64::abs).partial_cmp(&two.change.map(f64::abs)).unwrap_or(std::cmp::Ordering::Equal))
    }
}
