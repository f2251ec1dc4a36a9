//! Runs the settings of a study one by one, each in a process of its own, and keeps what they cost.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use super::{
    CostOptions,
    facts::{self, Facts},
    quantity::Quantity,
    record::{Measured, Outcome, Record},
    setting::{Setting, has_modes},
    store::Store,
    text,
};
use crate::{
    error::{Error, Result},
    output::say,
    scene::Scene,
    study::{
        fit::Power,
        launcher::{Job, Launcher, Scratch, WITHOUT_PICTURE, sweep_out},
    },
};

/// How seconds grow with the cells of a grid, at least and at most: in proportion, or with the iterations of a solver that feels the grid.
const GROWTH: [f64; 2] = [0.0, 2.0];

/// A study under way.
pub struct Sweep<'a> {
    options: &'a CostOptions,
    scene: &'a Scene,
    /// The scene as it is.
    pub facts: Facts,
    /// What is measured.
    pub quantity: Quantity,
    /// What was measured.
    pub store: Store,
    launcher: Launcher,
    scratch: Scratch,
    /// Settings of the ladders so far. What is affordable follows from these alone, so that a study that goes on decides as it did.
    climbed: Vec<Setting>,
}

impl<'a> Sweep<'a> {
    /// Makes a study ready; runs are done within its folder.
    ///
    /// # Errors
    /// The launcher or the folder cannot be used.
    pub fn new(
        options: &'a CostOptions,
        scene: &'a Scene,
        (facts, quantity, store): (Facts, Quantity, Store),
        folder: &Path,
    ) -> Result<Sweep<'a>> {
        let launcher = Launcher::new(&options.launcher, &options.petsc)?;
        sweep_out(folder);
        Ok(Sweep { options, scene, facts, quantity, store, launcher, scratch: Scratch::within(folder)?, climbed: Vec::new() })
    }

    /// Goes through settings by rising work, as far as the budget lets it; tells why it ended early.
    ///
    /// # Errors
    /// Runs cannot be started, or results cannot be written.
    pub fn climb(&mut self, settings: &[Setting]) -> Result<Option<String>> {
        let mut spent = 0.0;
        for (place, setting) in settings.iter().enumerate() {
            let predicted = self.predicted(setting).unwrap_or(0.0);
            if self.store.find(setting).is_none() && spent + predicted > self.options.budget {
                let left = settings.len() - place;
                return Ok(Some(format!(
                    "{}: {left} of {} settings left out from {} on: about {predicted:.0} s more, beyond --budget {}",
                    setting.method,
                    settings.len(),
                    setting.words(),
                    self.options.budget
                )));
            }
            spent += self.record(setting)?.measured().map_or(0.0, |measured| measured.wall_seconds);
            self.climbed.push(setting.clone());
        }
        Ok(None)
    }

    /// What comes of a setting, by a run if there was none.
    ///
    /// # Errors
    /// The run cannot be started, or its result cannot be written.
    pub fn record(&mut self, setting: &Setting) -> Result<&Record> {
        if self.store.find(setting).is_none() {
            let outcome = self.run(setting)?;
            self.store.add(setting.clone(), outcome)?;
            say(&text::progress(self.store.records().last().expect("one was added")))?;
        }
        Ok(self.store.find(setting).expect("it is there or was added"))
    }

    /// Seconds by the clock that a run would take, from the heaviest run of its method; nothing if there was none.
    pub fn predicted(&self, setting: &Setting) -> Option<f64> {
        let radius = self.radius();
        let work = |setting: &Setting| setting.work(self.facts.dimension, radius);
        let own = || self.runs().filter(|(climbed, _)| climbed.method == setting.method);
        let (heaviest, run) = own().max_by(|one, two| work(one.0).total_cmp(&work(two.0)))?;
        let points: Vec<(f64, f64)> =
            own().filter(|(climbed, _)| climbed.beside(heaviest)).map(|(climbed, run)| (work(climbed), run.seconds())).collect();
        let fitted = Power::fit(&points).map_or(1.0, |power| power.exponent);
        let [least, most] = GROWTH.map(|growth| 1.0 + growth / self.facts.dimension as f64);
        let growth = (work(setting) / work(heaviest)).powf(fitted.clamp(least, most));
        Some(run.wall_seconds * growth)
    }

    /// Whether a run beside the ladders costs neither more than the budget nor more than the ladders did.
    pub fn affordable(&self, setting: &Setting) -> bool {
        let spent = self.runs().map(|(_, run)| run.wall_seconds).sum();
        self.store.find(setting).is_some() || self.predicted(setting).is_some_and(|seconds| seconds <= self.options.budget.min(spent))
    }

    /// The runs of the ladders so far.
    fn runs(&self) -> impl Iterator<Item = (&Setting, &Measured)> {
        self.climbed.iter().filter_map(|setting| Some((setting, self.store.find(setting)?.measured()?)))
    }

    /// Radius of the smallest body, or 1 where spacings are lengths anyway.
    pub fn radius(&self) -> f64 {
        self.facts.radius.unwrap_or(1.0)
    }

    /// The scene with a setting.
    ///
    /// # Errors
    /// They do not go together.
    pub fn scene_with(&self, setting: &[String]) -> Result<Scene> {
        Scene::read(&self.options.scene, &[&self.options.overrides[..], setting].concat())
    }

    fn run(&self, setting: &Setting) -> Result<Outcome> {
        let scene = match self.scene_with(&setting.overrides()) {
            Ok(scene) => scene,
            Err(refusal) => return Ok(Outcome::Failed(refusal.to_string())),
        };
        let modes = if has_modes(&setting.method) { facts::modes(&scene) } else { Ok(None) };
        let modes = match modes {
            Ok(modes) => modes,
            Err(refusal) => return Ok(Outcome::Failed(refusal.to_string())),
        };
        let overrides = self.overrides(setting);
        let job = Job { scene: &self.options.scene, overrides: &overrides, folder: &self.out() };
        let read = |path: &Path| Measured::read(path, (setting, modes), &self.quantity, &self.facts);
        let start = Instant::now();
        Ok(match self.launcher.attempt((self.options.ranks, self.options.repeat), &job, read, Measured::seconds)? {
            Ok(measured) => Outcome::Measured(Measured { wall_seconds: start.elapsed().as_secs_f64(), ..measured }),
            Err(failure) => Outcome::Failed(reason(&failure)),
        })
    }

    fn out(&self) -> PathBuf {
        let out = self.scratch.0.join("out");
        // what a failed run has left there
        let _ = fs::remove_dir_all(&out);
        out
    }

    fn overrides(&self, setting: &Setting) -> Vec<String> {
        let mut overrides = self.options.overrides.clone();
        overrides.extend(setting.overrides());
        if !self.scene.scalar() {
            overrides.push(WITHOUT_PICTURE.into());
        }
        overrides.extend(self.quantity.probe.map(|points| format!("output.probe={points}")));
        if self.scene.time.is_some() {
            let end = self.scene.end();
            overrides.extend(["output.fields=false".into(), format!("output.every={end:?}"), "output.checkpoint=1e9".into()]);
        }
        overrides
    }
}

/// What a failed run said of itself.
fn reason(failure: &Error) -> String {
    let text = failure.to_string();
    let own = text.split_once("turbid: ").map_or(text.as_str(), |(_, own)| own);
    own.lines().collect::<Vec<_>>().join(" ")
}
