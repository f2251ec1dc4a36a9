//! Viscosity against fraction, with error bars, beside published laws; and how it evolves with strain.
//!
//! Points are means over configurations of hard bodies in equilibrium at an instant, with the standard error of these; curves are runs in time between sliding
//! images. Lubrication acts in all of them. Every one is a run of its own, started by a launcher; what was measured is kept in `viscosity.json` after every run, and a study that
//! is started again measures only what is missing.

mod laws;
mod record;
mod report;
mod scenes;

use std::{fs, path::PathBuf};

pub use self::record::SuspensionSetting;
use self::{
    record::{MeasuredViscosity, ViscosityRecord},
    report::ViscosityReport,
};
use super::command::{PetscOptions, Study, count, positive};
use crate::{
    error::{Error, Result},
    experiment::{
        Experiment,
        arguments::Start,
        launcher::{Job, LAUNCHER},
        store::StudyIdentity,
    },
    output::say,
};

/// What to measure, and how; absent numbers are those that suit each dimension.
#[derive(Debug, Clone, clap::Args)]
pub struct ViscosityStudy {
    /// Dimensions of space.
    #[arg(long, value_delimiter = ',', default_values_t = [2, 3])]
    pub dimensions: Vec<usize>,
    /// Fractions at which configurations in equilibrium are solved at an instant.
    #[arg(long, value_delimiter = ',', default_values_t = [0.05, 0.1, 0.2, 0.3, 0.4])]
    pub fractions: Vec<f64>,
    /// Configurations of each fraction, whose scatter gives the error bar.
    #[arg(long, default_value_t = 16, value_parser = count(1..))]
    pub configurations: usize,
    /// Bodies of each configuration (default: 64 in 2D, 27 in 3D).
    #[arg(long, value_parser = count(1..))]
    pub bodies: Option<usize>,
    /// Cells per radius (default: 5 in 2D, 4 in 3D).
    #[arg(long, value_parser = positive)]
    pub cells_per_radius: Option<f64>,
    /// Smallest gap between bodies at an instant, in radii.
    #[arg(long, default_value_t = 0.02, value_parser = positive)]
    pub gap: f64,
    /// Fraction of the runs in time, one in each dimension.
    #[arg(long, default_value_t = 0.3)]
    pub sheared_fraction: f64,
    /// Strain of the runs in time (0: none).
    #[arg(long, default_value_t = 2.0)]
    pub strain: f64,
    /// Ranks of each run.
    #[arg(long, default_value_t = 1, value_parser = count(1..))]
    pub ranks: usize,
    /// Command that starts a program on {ranks} ranks; without it one rank is started as it is.
    #[arg(long, default_value = LAUNCHER)]
    pub launcher: String,
    /// Folder for results; a study that was interrupted goes on there.
    #[arg(long, default_value = "out/viscosity")]
    pub out: PathBuf,
    /// Forget what was measured before.
    #[arg(long)]
    pub fresh: bool,
}

impl Study<PetscOptions> for ViscosityStudy {
    const NAME: &'static str = "viscosity";
    const ABOUT: &'static str =
        "Viscosity against fraction in 2D and 3D with error bars beside published laws, and against strain; starts its own runs";

    /// Makes the study and writes `viscosity.json`, `viscosity.csv` and the charts.
    fn run(&self, petsc: &PetscOptions) -> Result<()> {
        self.check()?;
        let start = Start { launcher: &self.launcher, petsc, ranks: self.ranks };
        let mut experiment = Experiment::open(&start, self.out.clone(), "viscosity.json", StudyIdentity::of_version(), self.fresh)?;
        let settings = self.settings();
        experiment.complete(&settings, |experiment, setting| self.measure(experiment, setting))?;
        let report = ViscosityReport::new(&settings, &experiment.store);
        say(&format!("{}\n{}", report.markdown(), experiment.write(None::<&()>, &report.files())?))
    }
}

impl ViscosityStudy {
    fn measure(&self, experiment: &Experiment<ViscosityRecord>, setting: &SuspensionSetting) -> Result<ViscosityRecord> {
        let scratch = &experiment.folder.scratch.0;
        let (scene, out) = (scratch.join("scene.toml"), scratch.join("run"));
        fs::write(&scene, setting.scene()?).map_err(|source| Error::File { path: scene.clone(), source })?;
        let job = Job { scene: &scene, overrides: &[], folder: &out, ranks: self.ranks, repeat: 1 };
        let measured = experiment.launcher.measure(&job, MeasuredViscosity::read, |measured| measured.seconds)?;
        Ok(ViscosityRecord { setting: setting.clone(), measured })
    }

    fn check(&self) -> Result<()> {
        let refuse = |option: &str, value: String, remedy: &str| Err(Error::refused(format!("--{option} {value}: {remedy}")));
        if let Some(dimension) = self.dimensions.iter().find(|dimension| !(2..=3).contains(*dimension)) {
            return refuse("dimensions", dimension.to_string(), "must be 2 or 3");
        }
        let fractions = self.fractions.iter().chain(std::iter::once(&self.sheared_fraction));
        match fractions.copied().find(|&fraction| !(fraction > 0.0 && fraction <= 0.5)) {
            Some(fraction) => {
                refuse("fractions", fraction.to_string(), "must be above 0 and at most 0.5, where bodies can be placed at random")
            }
            None => Ok(()),
        }
    }

    fn settings(&self) -> Vec<SuspensionSetting> {
        let mut settings = Vec::new();
        for &dimension in &self.dimensions {
            let base = SuspensionSetting {
                dimension,
                fraction: self.sheared_fraction,
                bodies: self.bodies.unwrap_or([64, 27][dimension - 2]),
                cells_per_radius: self.cells_per_radius.unwrap_or([5.0, 4.0][dimension - 2]),
                gap: self.gap,
                seed: 1,
                strain: None,
            };
            for &fraction in &self.fractions {
                let seeds = 1..=self.configurations as u64;
                settings.extend(seeds.map(|seed| SuspensionSetting { fraction, seed, ..base.clone() }));
            }
            if self.strain > 0.0 {
                settings.push(base.sheared(self.strain));
            }
        }
        settings
    }
}
