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

use self::{
    record::{Measured, Setting, Store},
    report::Report,
};
use super::launcher::{Job, Launcher, Scratch, sweep_out};
use crate::{
    error::{Error, Result},
    output::{FolderLock, note, prepare_folder, say, write_whole},
};

/// What to measure, and how; absent numbers are those that suit each dimension.
#[derive(Debug, Clone)]
pub struct ViscosityOptions {
    /// Dimensions of space.
    pub dimensions: Vec<usize>,
    /// Fractions of instants.
    pub fractions: Vec<f64>,
    /// Configurations of each fraction.
    pub configurations: usize,
    /// Bodies of each configuration.
    pub bodies: Option<usize>,
    /// Cells per radius.
    pub cells_per_radius: Option<f64>,
    /// Smallest gap between bodies at an instant, in radii.
    pub gap: f64,
    /// Fraction of runs in time.
    pub sheared_fraction: f64,
    /// Strain of runs in time; 0 for none.
    pub strain: f64,
    /// Ranks of each run.
    pub ranks: usize,
    /// Command line that starts a run, with `{ranks}` in it.
    pub launcher: String,
    /// Folder of the results.
    pub out: PathBuf,
    /// Whether what was measured before is forgotten.
    pub fresh: bool,
    /// Options for PETSc.
    pub petsc: Vec<String>,
}

/// Makes the study and writes `viscosity.json`, `viscosity.csv` and the charts.
///
/// # Errors
/// An option cannot be used, a run fails, or a file cannot be written.
pub fn viscosity(options: &ViscosityOptions) -> Result<()> {
    options.check()?;
    let launcher = Launcher::new(&options.launcher, &options.petsc)?;
    prepare_folder(&options.out)?;
    let _lock = FolderLock::take(&options.out)?;
    sweep_out(&options.out);
    let mut store = Store::open(&options.out, options.fresh)?;
    let settings = options.settings();
    let missing: Vec<&Setting> = settings.iter().filter(|setting| store.find(setting).is_none()).collect();
    let kept = settings.len() - missing.len();
    if kept > 0 {
        note(&format!("{kept} of {} runs were measured before", settings.len()));
    }
    let scratch = Scratch::within(&options.out)?;
    for (number, setting) in missing.iter().enumerate() {
        let measured = measure(&launcher, options.ranks, (setting, &scratch))?;
        note(&format!("{} of {}: {setting}: {:.4}, {:.1} s", number + 1, missing.len(), measured.relative, measured.seconds));
        store.add((*setting).clone(), measured)?;
    }
    let report = Report::new(&settings, &store);
    let files = report.files();
    for (name, text) in &files {
        write_whole(&options.out.join(name), text.as_bytes())?;
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    say(&format!("{}\nfiles: {}: viscosity.json, {}", report.markdown(), options.out.display(), names.join(", ")))
}

fn measure(launcher: &Launcher, ranks: usize, (setting, scratch): (&Setting, &Scratch)) -> Result<Measured> {
    let (scene, folder) = (scratch.0.join("scene.toml"), scratch.0.join("run"));
    fs::write(&scene, setting.scene()?).map_err(|source| Error::File { path: scene.clone(), source })?;
    let job = Job { scene: &scene, overrides: &[], folder: &folder };
    launcher.measure((ranks, 1), &job, Measured::read, |measured| measured.seconds)
}

impl ViscosityOptions {
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

    fn settings(&self) -> Vec<Setting> {
        let mut settings = Vec::new();
        for &dimension in &self.dimensions {
            let base = Setting {
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
                settings.extend(seeds.map(|seed| Setting { fraction, seed, ..base.clone() }));
            }
            if self.strain > 0.0 {
                settings.push(base.sheared(self.strain));
            }
        }
        settings
    }
}
