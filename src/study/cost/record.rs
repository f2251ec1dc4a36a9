//! What is kept of a run: its setting, the quantity, what it cost.

use std::{fmt, path::Path};

use serde::{Deserialize, Deserializer, Serialize};

use super::{
    format::seconds,
    metric::Metric,
    setting::{CostSetting, TimeStep},
    steadiness::still_to_come,
};
use crate::{
    error::Result,
    experiment::{self, record::RunOutcome, summary::RunSummary},
};

/// A setting and what came of it.
pub type CostRecord = experiment::record::Record<CostSetting, Measured>;

/// A run to its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The quantity.
    pub values: Vec<f64>,
    /// Spacing of the grid as it was.
    pub spacing: f64,
    /// Highest order of the surface modes, where the method has any.
    pub modes: Option<usize>,
    /// Unknowns of grid and surfaces.
    pub unknowns: f64,
    /// Iterations of a solve, in the mean.
    pub iterations: f64,
    /// Seconds of matrices, hierarchies and, at an instant, jump corrections.
    pub setup_seconds: f64,
    /// Seconds of the solve, or of all steps without their files.
    pub solve_seconds: f64,
    /// Steps; zero at an instant.
    pub steps: usize,
    /// Bytes of all ranks at their peak.
    pub memory_bytes: f64,
    /// A faster inverse of the fluid that the run could have taken.
    #[serde(deserialize_with = "inverse_alone")]
    pub faster: Option<String>,
    /// Relative change that is still to come after the end of the run, where the flow may become steady.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub still_to_come: Option<f64>,
    /// Cells that the thinnest boundary layer of such a flow has, where it is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boundary_layer: Option<f64>,
    /// Seconds by the clock, start of the program and repetitions included.
    pub wall_seconds: f64,
}

/// The name of an inverse, of which earlier studies tell the seconds too.
fn inverse_alone<'de, S: Deserializer<'de>>(source: S) -> std::result::Result<Option<String>, S::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum WrittenInverse {
        Name(String),
        WithSeconds((String, f64)),
    }
    Ok(Option::deserialize(source)?.map(|written| match written {
        WrittenInverse::Name(name) | WrittenInverse::WithSeconds((name, _)) => name,
    }))
}

/// What a run came to, in a line.
impl fmt::Display for CostRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match &self.outcome {
            RunOutcome::Failed(reason) => reason.clone(),
            RunOutcome::Measured(run) => {
                let value = run.value().map_or(String::new(), |value| format!("{value:.6} in "));
                format!("{value}{} s, {:.0} iterations", seconds(run.seconds()), run.iterations)
            }
        };
        write!(f, "{:<12} {:<48} {what}", self.setting.method, self.setting.words())
    }
}

impl Measured {
    /// Of a run that left a summary there; modes and seconds by the clock are left to whoever started it.
    ///
    /// # Errors
    /// The summary cannot be read or does not tell the quantity.
    pub fn read(path: &Path, setting: &CostSetting, metric: &Metric) -> Result<Measured> {
        let summary = RunSummary::read(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let values = metric.read(&summary, folder)?;
        Ok(Measured {
            values,
            spacing: spacing(&summary, setting, metric),
            modes: None,
            unknowns: summary.unknowns(),
            iterations: summary.iterations(),
            setup_seconds: summary.setup_seconds(),
            solve_seconds: summary.solve_seconds() - summary.number("/motion/output_seconds"),
            steps: summary.get("/steps").unwrap_or(0),
            memory_bytes: summary.memory_bytes(),
            faster: summary.faster(),
            still_to_come: still_to_come(metric, &summary, folder)?,
            boundary_layer: summary.get("/inertia/boundary_layer").filter(|_| metric.properties.steady),
            wall_seconds: 0.0,
        })
    }

    /// The quantity, where it is one number.
    pub fn value(&self) -> Option<f64> {
        if let [value] = self.values[..] { Some(value) } else { None }
    }

    /// The mean of its steps to a time.
    pub fn mean_step(&self, end: f64) -> TimeStep {
        TimeStep::Step(end / self.steps.max(1) as f64)
    }

    /// Seconds of everything.
    pub fn seconds(&self) -> f64 {
        self.setup_seconds + self.solve_seconds
    }

    /// Seconds of a run so many times as long.
    pub fn whole_seconds(&self, times: f64) -> f64 {
        self.setup_seconds + self.solve_seconds * times
    }
}

/// The spacing from the number of cells, because boxes hold whole ones; of a mesh that fits the bodies the one asked for.
fn spacing(summary: &RunSummary, setting: &CostSetting, metric: &Metric) -> f64 {
    let cells = summary.number("/parallel/cells/mean") * summary.get("/ranks").unwrap_or(1.0);
    match setting.method == "fitted" || cells <= 0.0 {
        true => setting.grid.spacing(metric.properties.unit()),
        false => (metric.properties.volume / cells).powf(1.0 / metric.properties.dimension as f64),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub mod tests {
    use std::fs;

    use super::*;
    use crate::{
        experiment::{
            arguments::Start,
            store::{Store, StudyIdentity},
        },
        scene::Scene,
        study::cost::setting::Resolution,
    };

    /// A run with a value on a grid.
    pub fn run(spacing: f64, value: f64) -> Measured {
        Measured {
            values: vec![value],
            spacing,
            modes: None,
            unknowns: 1.0,
            iterations: 1.0,
            setup_seconds: 0.0,
            solve_seconds: spacing.powi(-2),
            steps: 0,
            memory_bytes: 1.0,
            faster: None,
            still_to_come: None,
            boundary_layer: None,
            wall_seconds: 1.0,
        }
    }

    fn setting(cells: f64) -> CostSetting {
        CostSetting { method: "sharp".into(), grid: Resolution::CellsPerRadius(cells), modes: None, tolerance: None, step: None }
    }

    #[test]
    fn a_study_goes_on_with_its_own_runs_and_tries_failures_again() {
        let folder = std::env::temp_dir().join(format!("turbid-store-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let open = |title: &str, fresh| {
            let text = format!("title = {title:?}\ndomain.size = [1, 1]\nresolution.spacing = 0.1\n");
            let scene = Scene::parse("scene", Path::new(""), &text, &[]).unwrap();
            let start = Start { launcher: "srun -n {ranks}", petsc: &[], ranks: 1 };
            Store::<CostRecord>::open(&folder, "cost.json", StudyIdentity::of_scene(&scene, "quantity", "drag", &start).unwrap(), fresh)
        };
        let mut store = open("one", false).unwrap();
        let measured: Measured = serde_json::from_str(
            r#"{"values": [0.1], "spacing": 0.3, "modes": 4, "unknowns": 10, "iterations": 3, "setup_seconds": 1, "solve_seconds": 2,
                "steps": 0, "memory_bytes": 5, "faster": ["transform", 0.5], "wall_seconds": 4}"#,
        )
        .unwrap();
        store.add(CostRecord { setting: setting(4.0), outcome: RunOutcome::Measured(measured.clone()) }).unwrap();
        store.add(CostRecord { setting: setting(5.0), outcome: RunOutcome::Failed("no".into()) }).unwrap();
        let again = open("one", false).unwrap();
        assert_eq!(again.records().len(), 1);
        assert_eq!(again.find(&setting(4.0)).unwrap().measured(), Some(&measured));
        let refusal = open("two", false).err().unwrap().to_string();
        assert!(
            refusal.contains("holds a study that differs in the scene; choose another folder, or start anew with --fresh"),
            "{refusal}"
        );
        assert!(open("two", true).unwrap().records().is_empty());
        fs::write(folder.join("cost.json"), b"{").unwrap();
        assert!(open("one", false).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn only_steps_grow_with_the_length_of_a_scene() {
        assert_eq!(Measured { setup_seconds: 1.0, solve_seconds: 30.0, ..run(1.0, 1.0) }.whole_seconds(2.0), 61.0);
    }
}
