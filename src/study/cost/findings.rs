//! What a study found, as numbers: for `cost.json`, `cost.csv`, and the texts and pictures made of it.

use serde::Serialize;

use super::{
    cheapest::Cheapest,
    record::{CostRecord, Measured},
    reference::Reference,
    sensitivity::Sensitivity,
    setting::{CostSetting, Resolution},
};

/// All that a study found.
#[derive(Debug, Clone, Serialize)]
pub struct Findings {
    /// Title of the scene.
    pub title: String,
    /// The quantity in words.
    pub quantity: String,
    /// Its word.
    pub name: &'static str,
    /// Ranks of each run.
    pub ranks: usize,
    /// Runs of each setting, of which the fastest counts.
    pub repeat: usize,
    /// Wanted relative error.
    pub wanted: f64,
    /// Length of the whole scene over that of a run.
    pub times: f64,
    /// What errors are measured against, if enough was measured to tell.
    pub reference: Option<Reference>,
    /// All settings that were swept.
    pub points: Vec<SettingFinding>,
    /// Method by method.
    pub methods: Vec<MethodFinding>,
    /// The scene as it is written, if it was measured.
    pub written: Option<CostSetting>,
    /// Settings whose parameters were changed.
    #[serde(rename = "turned")]
    pub sensitivities: Vec<Sensitivity>,
    /// What else is to be said.
    pub notes: Vec<String>,
}

/// A setting of the sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SettingFinding {
    /// The setting.
    pub setting: CostSetting,
    /// Cells across the radius of the smallest body, as the grid was.
    pub cells_per_radius: Option<f64>,
    /// The run, without its values.
    pub measured: Option<Measured>,
    /// The quantity, where it is one number.
    pub value: Option<f64>,
    /// Relative error, with its sign where the quantity is one number.
    pub error: Option<f64>,
    /// Whether it is no larger than the uncertainty of the reference.
    pub within_uncertainty: bool,
    /// Why there is no run.
    pub remark: Option<String>,
}

/// What is found about a method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodFinding {
    /// Its word.
    pub method: String,
    /// Order of the error in the spacing, fitted.
    pub order: Option<f64>,
    /// Order that theory predicts.
    pub predicted_order: f64,
    /// Exponent of the seconds in the spacing, fitted.
    pub seconds_exponent: Option<f64>,
    /// The setting that reaches the wanted error in the least time.
    pub cheapest: Option<Cheapest>,
}

impl SettingFinding {
    /// Of a record; `error` tells the relative error of values, if there is a reference.
    pub fn of(record: &CostRecord, radius: Option<f64>, error: impl Fn(&[f64]) -> Option<f64>, uncertainty: f64) -> SettingFinding {
        let measured = record.measured();
        let error = measured.and_then(|measured| error(&measured.values));
        SettingFinding {
            setting: record.setting.clone(),
            cells_per_radius: measured.and_then(|measured| Some(radius? / measured.spacing)),
            value: measured.and_then(Measured::value),
            error,
            within_uncertainty: error.is_some_and(|error| error.abs() <= uncertainty),
            measured: measured.map(|measured| Measured { values: Vec::new(), ..measured.clone() }),
            remark: record.failure().map(str::to_owned),
        }
    }

    /// Order of the modes, if there are any.
    pub fn modes(&self) -> Option<usize> {
        self.measured.as_ref().and_then(|run| run.modes).or(self.setting.modes)
    }

    /// Cells across the smallest radius, or the spacing where there are no bodies.
    pub fn resolution(&self) -> String {
        match (self.cells_per_radius, self.setting.grid) {
            (Some(cells), _) | (None, Resolution::CellsPerRadius(cells)) => format!("{cells:.1}").trim_end_matches(".0").to_owned(),
            (None, Resolution::Spacing(spacing) | Resolution::Exactly(spacing)) => format!("h = {spacing:.4}"),
        }
    }
}

impl Findings {
    /// The cheapest of all measured settings that reach the wanted error.
    pub fn cheapest(&self) -> Option<&Cheapest> {
        let measured = self.methods.iter().filter_map(|method| method.cheapest.as_ref()).filter(|cheapest| cheapest.measured);
        measured.min_by(|one, two| one.seconds.total_cmp(&two.seconds))
    }

    /// The point of a setting.
    pub fn point(&self, setting: &CostSetting) -> Option<&SettingFinding> {
        self.points.iter().find(|point| point.setting == *setting)
    }

    /// Uncertainty of the reference.
    pub fn uncertainty(&self) -> f64 {
        self.reference.as_ref().map_or(0.0, |reference| reference.uncertainty)
    }
}
