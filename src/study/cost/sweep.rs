//! Runs the settings of a study one by one, each in a process of its own, and keeps what they cost.

use std::{fs, path::PathBuf, time::Instant};

use super::{
    metric::Metric,
    options::CostStudy,
    properties::SceneProperties,
    record::{CostRecord, Measured},
    setting::{CostSetting, TimeStep, has_modes},
};
use crate::{
    error::Result,
    experiment::{
        Experiment,
        launcher::{Job, WITHOUT_PICTURE},
        record::RunOutcome,
    },
    output::say,
    scene::Scene,
    study::fit::Power,
};

/// How seconds grow with the cells of a grid, at least and at most: in proportion, or with the iterations of a solver that feels the grid.
const GROWTH: [f64; 2] = [0.0, 2.0];

/// Seconds that a run beside the sequences may always take.
const NEGLIGIBLE: f64 = 5.0;

/// The runs of a study.
pub struct Sweep<'a> {
    /// What was asked for.
    pub options: &'a CostStudy,
    /// The scene as runs have it.
    pub scene: &'a Scene,
    /// What is measured.
    pub metric: Metric,
    /// What runs them, and what was measured.
    pub experiment: Experiment<CostRecord>,
    /// Settings of the sequences so far. What is affordable follows from these alone, so that a study that goes on decides as it did.
    pub measured: Vec<CostSetting>,
}

impl Sweep<'_> {
    /// Goes through settings by rising work, as far as the budget lets it; tells why it ended early.
    ///
    /// # Errors
    /// Runs cannot be started, or results cannot be written.
    pub fn measure(&mut self, settings: &[CostSetting]) -> Result<Option<String>> {
        let (mut spent, budget) = (0.0, self.options.seconds());
        for (place, setting) in settings.iter().enumerate() {
            let predicted = self.predicted(setting).unwrap_or(0.0);
            if self.experiment.store.find(setting).is_none() && spent + predicted > budget {
                let left = settings.len() - place;
                return Ok(Some(format!(
                    "{}: {left} of {} settings left out from {} on: about {predicted:.0} s more, beyond --budget {budget}",
                    setting.method,
                    settings.len(),
                    setting.words(),
                )));
            }
            spent += self.record(setting)?.measured().map_or(0.0, |measured| measured.wall_seconds);
            self.measured.push(setting.clone());
        }
        Ok(None)
    }

    /// What comes of a setting, by a run if there was none.
    ///
    /// # Errors
    /// The run cannot be started, or its result cannot be written.
    pub fn record(&mut self, setting: &CostSetting) -> Result<&CostRecord> {
        if self.experiment.store.find(setting).is_none() {
            let outcome = self.run(setting)?;
            let record = CostRecord { setting: setting.clone(), outcome };
            let progress = record.to_string();
            self.experiment.store.add(record)?;
            say(&progress)?;
        }
        Ok(self.experiment.store.find(setting).expect("it is there or was added"))
    }

    /// Seconds by the clock that a run would take, from the heaviest run of its method; nothing if there was none.
    pub fn predicted(&self, setting: &CostSetting) -> Option<f64> {
        let properties = &self.metric.properties;
        let work = |setting: &CostSetting| setting.work(properties.dimension, properties.unit());
        let own: Vec<(CostSetting, &Measured)> = self
            .runs()
            .filter(|(other, _)| other.method == setting.method)
            .map(|(other, run)| (self.comparable(other, run, setting), run))
            .collect();
        let (heaviest, run) = own.iter().max_by(|one, two| work(&one.0).total_cmp(&work(&two.0)))?;
        let alike = own.iter().filter(|(other, _)| other.differs_in_grid_alone(heaviest));
        let points: Vec<(f64, f64)> = alike.map(|(other, run)| (work(other), run.seconds())).collect();
        let fitted = Power::fit(&points).map_or(1.0, |power| power.exponent);
        let [least, most] = GROWTH.map(|growth| 1.0 + growth / properties.dimension as f64);
        let growth = (work(setting) / work(heaviest)).powf(fitted.clamp(least, most));
        Some(run.wall_seconds * growth)
    }

    /// The setting of a run with steps that compare with those of another: with the mean of those that followed the grid, where the other's have a length.
    fn comparable(&self, setting: &CostSetting, run: &Measured, other: &CostSetting) -> CostSetting {
        let step = match (setting.step, other.step) {
            (Some(step), Some(TimeStep::Step(_))) if step.follows_grid(self.scene) => Some(run.mean_step(self.scene.end())),
            (step, _) => step,
        };
        CostSetting { step, ..setting.clone() }
    }

    /// Whether a run beside the sequences costs neither more than the budget nor more than the sequences did and a few seconds, or twice that for a step of its own
    /// where those of the sequences followed the grid: only such a run tells the errors of grid and steps apart.
    pub fn affordable(&self, setting: &CostSetting) -> bool {
        let own_step =
            matches!(setting.step, Some(TimeStep::Step(_))) && TimeStep::of(self.scene).is_some_and(|step| step.follows_grid(self.scene));
        let spent = self.runs().map(|(_, run)| run.wall_seconds).sum::<f64>().max(NEGLIGIBLE);
        let most = self.options.seconds().min(if own_step { 2.0 * spent } else { spent });
        self.experiment.store.find(setting).is_some() || self.predicted(setting).is_some_and(|seconds| seconds <= most)
    }

    /// The runs of the sequences so far.
    fn runs(&self) -> impl Iterator<Item = (&CostSetting, &Measured)> {
        self.measured.iter().filter_map(|setting| Some((setting, self.experiment.store.find(setting)?.measured()?)))
    }

    /// The scene with a setting.
    ///
    /// # Errors
    /// They do not go together.
    pub fn scene_with(&self, setting: &[String]) -> Result<Scene> {
        Scene::read(&self.options.scene.scene, &[&self.options.scene.overrides[..], setting].concat())
    }

    fn run(&self, setting: &CostSetting) -> Result<RunOutcome<Measured>> {
        let order = |scene: Scene| if has_modes(&setting.method) { Ok(SceneProperties::of(&scene)?.modes) } else { Ok(None) };
        let modes = match self.scene_with(&setting.overrides()).and_then(order) {
            Ok(modes) => modes,
            Err(refusal) => return Ok(RunOutcome::Failed(refusal.to_string())),
        };
        let (overrides, folder) = (self.overrides(setting), self.out());
        let CostStudy { scene, ranks, start, .. } = self.options;
        let job = Job { scene: &scene.scene, overrides: &overrides, folder: &folder, ranks: *ranks, repeat: start.repeat };
        let begin = Instant::now();
        let outcome = self.experiment.launcher.outcome(&job, |path| Measured::read(path, setting, &self.metric), Measured::seconds)?;
        Ok(match outcome {
            RunOutcome::Measured(measured) => {
                RunOutcome::Measured(Measured { modes, wall_seconds: begin.elapsed().as_secs_f64(), ..measured })
            }
            failed => failed,
        })
    }

    fn out(&self) -> PathBuf {
        let out = self.experiment.folder.scratch.0.join("out");
        // what a failed run has left there
        let _ = fs::remove_dir_all(&out);
        out
    }

    fn overrides(&self, setting: &CostSetting) -> Vec<String> {
        let mut overrides = self.options.scene.overrides.clone();
        overrides.extend(setting.overrides());
        if !self.scene.scalar() {
            overrides.push(WITHOUT_PICTURE.into());
        }
        overrides.extend(self.metric.quantity.probe.map(|points| format!("output.probe={points}")));
        if self.scene.time.is_some() {
            let end = self.scene.end();
            overrides.extend(["output.fields=false".into(), format!("output.every={end:?}"), "output.checkpoint=1e9".into()]);
        }
        overrides
    }
}
