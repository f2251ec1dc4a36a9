//! What a study found, as numbers: for `cost.json`, `cost.csv`, and the texts and pictures made of it.

use serde::Serialize;

use super::{
    choice::Cheapest,
    knobs::Turned,
    record::{Measured, Outcome, Record},
    reference::Reference,
    setting::Setting,
    table::cells_per_radius,
};

/// Names of the numbers of a row in `cost.csv`.
const COLUMNS: &str = "method,cells_per_radius,spacing,modes,tolerance,step,unknowns,iterations,setup_seconds,solve_seconds,\
    memory_bytes,value,error,within_uncertainty,remark";

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
    pub points: Vec<Point>,
    /// Method by method.
    pub methods: Vec<MethodFinding>,
    /// The scene as it is written, if it was measured.
    pub written: Option<Setting>,
    /// Settings whose knobs were turned.
    pub turned: Vec<Turned>,
    /// What else is to be said.
    pub notes: Vec<String>,
}

/// A setting of the sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// The setting.
    pub setting: Setting,
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

impl Point {
    /// Of a record; `error` tells the relative error of values, if there is a reference.
    pub fn of(record: &Record, radius: Option<f64>, error: impl Fn(&[f64]) -> Option<f64>, uncertainty: f64) -> Point {
        let measured = record.measured();
        let error = measured.and_then(|measured| error(&measured.values));
        Point {
            setting: record.setting.clone(),
            cells_per_radius: measured.and_then(|measured| Some(radius? / measured.spacing)),
            value: measured.and_then(|measured| if let [value] = measured.values[..] { Some(value) } else { None }),
            error,
            within_uncertainty: error.is_some_and(|error| error.abs() <= uncertainty),
            measured: measured.map(|measured| Measured { values: Vec::new(), ..measured.clone() }),
            remark: match &record.outcome {
                Outcome::Measured(_) => None,
                Outcome::Failed(reason) => Some(reason.clone()),
            },
        }
    }

    fn csv(&self) -> String {
        let Point { setting, measured, value, error, within_uncertainty, remark, .. } = self;
        let cells = cells_per_radius(self);
        let number = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
        let of = |read: fn(&Measured) -> f64| number(measured.as_ref().map(read));
        let modes = measured.as_ref().and_then(|measured| measured.modes).or(setting.modes);
        let costs = [
            of(|run| run.unknowns),
            of(|run| run.iterations),
            of(|run| run.setup_seconds),
            of(|run| run.solve_seconds),
            of(|run| run.memory_bytes),
        ];
        let (tolerance, step) = (number(setting.tolerance), number(setting.step.map(|step| step.length())));
        let remark = remark.as_deref().unwrap_or_default().replace('"', "'");
        format!(
            "{},{cells},{},{},{tolerance},{step},{},{},{},{within_uncertainty},\"{remark}\"\n",
            setting.method,
            of(|run| run.spacing),
            modes.map_or(String::new(), |modes| modes.to_string()),
            costs.join(","),
            number(*value),
            number(*error),
        )
    }
}

impl Findings {
    /// The points as a table for programs.
    pub fn csv(&self) -> String {
        format!("{COLUMNS}\n{}", self.points.iter().map(Point::csv).collect::<String>())
    }

    /// The cheapest of all measured settings that reach the wanted error.
    pub fn cheapest(&self) -> Option<&Cheapest> {
        let measured = self.methods.iter().filter_map(|method| method.cheapest.as_ref()).filter(|cheapest| cheapest.measured);
        measured.min_by(|one, two| one.seconds.total_cmp(&two.seconds))
    }

    /// The point of a setting.
    pub fn point(&self, setting: &Setting) -> Option<&Point> {
        self.points.iter().find(|point| point.setting == *setting)
    }

    /// Uncertainty of the reference.
    pub fn uncertainty(&self) -> f64 {
        self.reference.as_ref().map_or(0.0, |reference| reference.uncertainty)
    }
}
