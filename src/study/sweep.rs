//! A quantity of a scene against keys of it that are varied, each point with its scatter over seeds.
//!
//! Every setting is a run of its own, started by a launcher; what was measured is kept in `sweep.json` after every run, and a sweep that is started
//! again measures only what is missing. A run that fails is reported and tried again by the next start.

mod keep;
mod point;
mod quantity;
mod reading;
mod record;
mod report;
mod vary;

use std::path::{Path, PathBuf};

use self::{
    keep::Keep,
    quantity::SweepQuantity,
    record::{Measured, SweepRecord, SweepSetting},
    report::SweepReport,
    vary::Vary,
};
use super::command::{PetscOptions, SceneArguments, Study, count};
use crate::{
    error::{Error, Result},
    experiment::{
        Experiment,
        arguments::Start,
        launcher::{Job, LAUNCHER, WITHOUT_PICTURE},
        record::RunOutcome,
        store::StudyIdentity,
        summary::RunSummary,
    },
    output::{SWEEP, SWEEP_RUNS, say},
    scene::{BodyGroup, Scene},
};

/// What to vary and what to measure.
#[derive(Debug, Clone, clap::Args)]
pub struct ParameterSweep {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Key and the values that it takes in turn, as --vary bodies.0.fraction=0.1,0.2,0.3; several keys are combined.
    #[arg(long, value_name = "KEY=A,B,..", required = true)]
    pub vary: Vec<String>,
    /// Runs of each point, with the seeds from that of the scene on; their scatter gives the interval.
    #[arg(long, default_value_t = 1, value_parser = count(1..=10_000))]
    pub seeds: usize,
    /// viscosity, drag, settling, columns as series.kinetic_energy, their last entries as last.kinetic_energy, or keys of summary.json as flow.mean_velocity.0; several are separated by commas
    /// (default: what the scene is about).
    #[arg(long, value_delimiter = ',', value_name = "QUANTITY,..")]
    pub quantity: Vec<String>,
    /// What is kept of each run in the folder runs: its summary, series and scene, all of its files, or nothing.
    #[arg(long, value_enum, default_value_t = Keep::Series)]
    pub keep: Keep,
    /// Ranks of each run.
    #[arg(long, default_value_t = 1, value_parser = count(1..))]
    pub ranks: usize,
    /// Command that starts a program on {ranks} ranks; without it one rank is started as it is.
    #[arg(long, default_value = LAUNCHER)]
    pub launcher: String,
    /// Folder for results; a sweep that was interrupted goes on there (default: out/NAME-sweep of the scene).
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Forget what was measured before.
    #[arg(long)]
    pub fresh: bool,
}

impl Study<PetscOptions> for ParameterSweep {
    const NAME: &'static str = "sweep";
    const ABOUT: &'static str = "A quantity against keys of a scene that are varied, with intervals over seeds; starts its own runs";

    /// Runs what is missing and writes `sweep.json`, `sweep.csv`, `sweep.md` and `sweep.svg`.
    fn run(&self, petsc: &PetscOptions) -> Result<()> {
        let scene = Scene::read(&self.scene.scene, &self.scene.overrides)?;
        let keys = Vary::parse_all(&self.vary)?;
        let settings = self.settings(&scene, &keys)?;
        // a key that is misspelt is refused before anything is run
        let scenes = settings.iter().map(|setting| self.scene_of(setting)).collect::<Result<Vec<_>>>()?;
        let quantities = SweepQuantity::all(&self.quantity, &scenes[0])?;
        let start = Start { launcher: &self.launcher, petsc, ranks: self.ranks };
        let names: Vec<String> = quantities.iter().map(SweepQuantity::name).collect();
        let identity = StudyIdentity::of_scene(&scene, "quantities", &names, &start)?;
        let folder = self.out.clone().unwrap_or_else(|| format!("out/{}-sweep", scene.name).into());
        let mut experiment = Experiment::open(&start, folder, SWEEP, identity, self.fresh)?;
        let words: Vec<String> =
            quantities.iter().map(|quantity| format!("quantity: {}\n", quantity.words(scene.time.is_some()))).collect();
        say(&format!("{}\n{}", scene.shown_title(), words.concat()))?;
        experiment.complete(&settings, |experiment, setting| {
            let outcome = self.measure(experiment, setting, &quantities)?;
            Ok(SweepRecord { setting: setting.clone(), outcome })
        })?;
        let report = SweepReport::new(scene.shown_title(), names, &keys, &settings, &experiment.store);
        let written = experiment.write(Some(&report), &report.files())?;
        let kept = if self.keep == Keep::Nothing { String::new() } else { format!("; runs in {}", SWEEP_RUNS) };
        say(&format!("{}\n\n{written}{kept}", report.markdown()))?;
        match report.points.iter().any(|point| point.runs > 0) {
            true => Ok(()),
            false => Err(Error::refused("no run came to its end; the reasons stand below the table")),
        }
    }
}

impl ParameterSweep {
    /// Every run: seeds of a point next to each other.
    fn settings(&self, scene: &Scene, keys: &[Vary]) -> Result<Vec<SweepSetting>> {
        let refuse = |reason: &str| Err(Error::refused(format!("--seeds {}: {reason}", self.seeds)));
        let seed_varies = keys.iter().any(|vary| vary.key == "seed");
        if self.seeds > 1 && seed_varies {
            return refuse("the seed is one of the keys that are varied; leave one of both out");
        }
        let random = |scene: &Scene| scene.bodies.iter().any(BodyGroup::at_random);
        let points = vary::points(keys);
        let setting = |point: &Vec<_>, seed| SweepSetting { point: point.clone(), seed };
        // what is wrong with a scene is told when all of them are read
        let differs = |point: &Vec<_>| self.scene_of(&setting(point, None)).map_or(true, |scene| random(&scene));
        if self.seeds > 1 && !points.iter().any(differs) {
            return refuse("the places of all bodies are given, so that runs with other seeds are the same; leave the flag out");
        }
        let seeds = || if seed_varies { vec![None] } else { (0..self.seeds as u64).map(|more| Some(scene.seed + more)).collect() };
        Ok(points.iter().flat_map(|point| seeds().into_iter().map(move |seed| setting(point, seed))).collect())
    }

    fn overrides(&self, setting: &SweepSetting) -> Vec<String> {
        [&self.scene.overrides[..], &setting.overrides()].concat()
    }

    fn scene_of(&self, setting: &SweepSetting) -> Result<Scene> {
        Scene::read(&self.scene.scene, &self.overrides(setting))
    }

    fn measure(
        &self,
        experiment: &Experiment<SweepRecord>,
        setting: &SweepSetting,
        quantities: &[SweepQuantity],
    ) -> Result<RunOutcome<Measured>> {
        let scene = &self.scene_of(setting)?;
        let picture = (!scene.scalar()).then(|| WITHOUT_PICTURE.to_owned());
        let overrides: Vec<String> = self.overrides(setting).into_iter().chain(picture).collect();
        let (folder, out) = (&experiment.folder.path, experiment.folder.scratch.0.join("run"));
        let job = Job { scene: &self.scene.scene, overrides: &overrides, folder: &out, ranks: self.ranks, repeat: 1 };
        let read = |path: &Path| {
            let readings = quantities.iter().map(|quantity| quantity.read(path, scene)).collect::<Result<Vec<_>>>()?;
            if readings.iter().all(Option::is_none) {
                let names: Vec<String> = quantities.iter().map(SweepQuantity::name).collect();
                return Err(Error::refused(format!("--quantity {}: the run does not report it; choose another", names.join(","))));
            }
            let summary = RunSummary::read(path)?;
            let kept = self.keep.keep(&out, folder, &setting.folder_name())?;
            let seconds = summary.setup_seconds() + summary.solve_seconds();
            Ok(Measured { readings, fraction: summary.number("/fraction"), seconds, folder: kept })
        };
        let outcome = experiment.launcher.outcome(&job, read, |measured| measured.seconds)?;
        self.keep.keep_failed(&out, folder, &setting.folder_name())?;
        Ok(outcome)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::study::command::from_words;

    #[test]
    fn the_words_of_a_sweep_are_its_arguments() {
        let sweep: ParameterSweep = from_words(&["a.toml", "--vary", "a=1,2", "--vary", "b=[1, 2],[3, 4]", "--seeds", "5"]);
        let several: ParameterSweep = from_words(&["a.toml", "--vary", "a=1", "--quantity", "viscosity,series.contacts", "--keep", "all"]);
        assert_eq!((several.quantity, several.keep), (vec!["viscosity".to_owned(), "series.contacts".into()], Keep::All));
        assert_eq!((sweep.scene.scene, sweep.vary, sweep.seeds), ("a.toml".into(), vec!["a=1,2".into(), "b=[1, 2],[3, 4]".into()], 5));
    }
}
