//! `viscosity.json`: all that was measured, written whole after every run, and read again when a study goes on.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use crate::{
    error::{Error, Result},
    output::{CurvePoint, MeanViscosity, write_whole},
};

const FILE: &str = "viscosity.json";

/// A run: everything that decides what comes out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Dimension of space.
    pub dimension: usize,
    /// Part of the box that bodies fill.
    pub fraction: f64,
    /// Number of bodies.
    pub bodies: usize,
    /// Cells per radius.
    pub cells_per_radius: f64,
    /// Smallest gap at the start, in radii.
    pub gap: f64,
    /// Seed of their places.
    pub seed: u64,
    /// Strain of a run in time; an instant has none.
    pub strain: Option<f64>,
}

/// What came out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Relative viscosity, at the end of a run in time.
    pub relative: f64,
    /// Mean over its steady part, if it has become steady.
    pub mean: Option<MeanViscosity>,
    /// Strain and relative viscosity at the steps of a run in time.
    pub curve: Vec<(f64, f64)>,
    /// Seconds of set-up, assembly and solve, or of all steps.
    pub seconds: f64,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Record {
    setting: Setting,
    measured: Measured,
}

#[derive(Serialize, Deserialize)]
struct Saved {
    version: String,
    records: Vec<Record>,
}

/// The records of a folder.
pub struct Store {
    path: PathBuf,
    saved: Saved,
}

impl Store {
    /// The records of a folder; none if the study starts anew.
    ///
    /// # Errors
    /// [`Error::Refused`] if another version wrote them and nobody said `fresh`.
    pub fn open(folder: &Path, fresh: bool) -> Result<Store> {
        let (path, version) = (folder.join(FILE), env!("CARGO_PKG_VERSION").to_owned());
        let mut saved = Saved { version: version.clone(), records: Vec::new() };
        if path.exists() && !fresh {
            let text = fs::read_to_string(&path).map_err(|source| Error::File { path: path.clone(), source })?;
            let known = serde_json::from_str::<Saved>(&text).ok().filter(|known| known.version == version);
            let remedy = "its viscosity.json is not one that this version wrote; choose another folder, or start anew with --fresh";
            saved = known.ok_or_else(|| Error::refused(format!("--out {}: {remedy}", folder.display())))?;
        }
        Ok(Store { path, saved })
    }

    /// What came out of a setting, if it was measured.
    pub fn find(&self, setting: &Setting) -> Option<&Measured> {
        self.saved.records.iter().find(|record| record.setting == *setting).map(|record| &record.measured)
    }

    /// Adds a run and writes all of them.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, setting: Setting, measured: Measured) -> Result<()> {
        self.saved.records.push(Record { setting, measured });
        let json = serde_json::to_string(&self.saved).expect("a study is plain numbers and text");
        write_whole(&self.path, (json + "\n").as_bytes())
    }
}

impl Measured {
    /// From the summary of a run and the series beside it.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn read(summary: &Path) -> Result<Measured> {
        let read = |path: &Path| fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source });
        let value: serde_json::Value = serde_json::from_str(&read(summary)?).unwrap_or_default();
        let number = |pointer: &str| value.pointer(pointer).and_then(serde_json::Value::as_f64);
        let missing = || Error::Diverged(format!("{}: holds no viscosity", summary.display()));
        let relative = number("/viscosity/relative").ok_or_else(missing)?;
        let instant = || ["setup", "assembly", "solve"].iter().filter_map(|stage| number(&format!("/solver/{stage}_seconds"))).sum();
        let series = summary.with_file_name("series.csv");
        let curve = if series.exists() { CurvePoint::read(&read(&series)?) } else { Vec::new() };
        Ok(Measured {
            relative,
            mean: value.pointer("/viscosity/mean").and_then(|mean| serde_json::from_value(mean.clone()).ok()),
            curve: curve.iter().map(|point| (point.strain, point.relative())).collect(),
            seconds: number("/motion/seconds").unwrap_or_else(instant),
        })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Setting { dimension, fraction, seed, .. } = self;
        match self.strain {
            None => write!(f, "{dimension}D, fraction {fraction}, configuration {seed}"),
            Some(strain) => write!(f, "{dimension}D, fraction {fraction}, to strain {strain}"),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_study_goes_on_with_what_it_measured() {
        let folder = std::env::temp_dir().join(format!("turbid-viscosity-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let setting = |seed| Setting { dimension: 2, fraction: 0.1, bodies: 4, cells_per_radius: 4.0, gap: 0.02, seed, strain: None };
        let measured = Measured { relative: 1.25, mean: None, curve: vec![(0.0, 1.25), (0.1, 1.0 / 3.0)], seconds: 0.5 };
        Store::open(&folder, false).unwrap().add(setting(1), measured.clone()).unwrap();
        let store = Store::open(&folder, false).unwrap();
        assert_eq!((store.find(&setting(1)), store.find(&setting(2))), (Some(&measured), None));
        assert!(Store::open(&folder, true).unwrap().find(&setting(1)).is_none());
        fs::write(folder.join(FILE), "{").unwrap();
        let refusal = Store::open(&folder, false).err().unwrap().to_string();
        assert!(refusal.contains("start anew with --fresh"), "{refusal}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
