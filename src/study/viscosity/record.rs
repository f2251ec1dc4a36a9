//! What is kept of a run of the study: its setting, and what came out.

use std::{fmt, fs, path::Path};

use serde::{Deserialize, Serialize};

use crate::{
    error::{Error, Result},
    experiment::{store::Recorded, summary::RunSummary},
    output::{CurvePoint, MeanViscosity},
};

/// A run: everything that decides what comes out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SuspensionSetting {
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
pub struct MeasuredViscosity {
    /// Relative viscosity, at the end of a run in time.
    pub relative: f64,
    /// Mean over its steady part, if it has become steady.
    pub mean: Option<MeanViscosity>,
    /// Strain and relative viscosity at the steps of a run in time.
    pub curve: Vec<(f64, f64)>,
    /// Seconds of set-up, assembly and solve, or of all steps.
    pub seconds: f64,
}

/// A setting and what came of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ViscosityRecord {
    /// The setting.
    pub setting: SuspensionSetting,
    /// What came out.
    pub measured: MeasuredViscosity,
}

impl Recorded for ViscosityRecord {
    type Setting = SuspensionSetting;

    fn setting(&self) -> &SuspensionSetting {
        &self.setting
    }
}

impl MeasuredViscosity {
    /// From the summary of a run and the series beside it.
    ///
    /// # Errors
    /// They cannot be read.
    pub fn read(path: &Path) -> Result<MeasuredViscosity> {
        let summary = RunSummary::read(path)?;
        let missing = || Error::Diverged(format!("{}: holds no viscosity", path.display()));
        let relative = summary.get("/viscosity/relative").ok_or_else(missing)?;
        let series = path.with_file_name("series.csv");
        let curve = match series.exists() {
            true => CurvePoint::read(&fs::read_to_string(&series).map_err(|source| Error::File { path: series, source })?),
            false => Vec::new(),
        };
        Ok(MeasuredViscosity {
            relative,
            mean: summary.get("/viscosity/mean"),
            curve: curve.iter().map(|point| (point.strain, point.relative())).collect(),
            seconds: if summary.in_time() { summary.solve_seconds() } else { summary.setup_seconds() + summary.solve_seconds() },
        })
    }
}

impl fmt::Display for SuspensionSetting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SuspensionSetting { dimension, fraction, seed, .. } = self;
        match self.strain {
            None => write!(f, "{dimension}D, fraction {fraction}, configuration {seed}"),
            Some(strain) => write!(f, "{dimension}D, fraction {fraction}, to strain {strain}"),
        }
    }
}

impl fmt::Display for ViscosityRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {:.4}, {:.1} s", self.setting, self.measured.relative, self.measured.seconds)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::experiment::store::{Store, StudyIdentity};

    #[test]
    fn a_study_goes_on_with_what_it_measured() {
        let folder = std::env::temp_dir().join(format!("turbid-viscosity-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let setting =
            |seed| SuspensionSetting { dimension: 2, fraction: 0.1, bodies: 4, cells_per_radius: 4.0, gap: 0.02, seed, strain: None };
        let measured = MeasuredViscosity { relative: 1.25, mean: None, curve: vec![(0.0, 1.25), (0.1, 1.0 / 3.0)], seconds: 0.5 };
        let open = |fresh| Store::<ViscosityRecord>::open(&folder, "viscosity.json", StudyIdentity::of_version(), fresh);
        open(false).unwrap().add(ViscosityRecord { setting: setting(1), measured: measured.clone() }).unwrap();
        let store = open(false).unwrap();
        assert_eq!(store.find(&setting(1)).map(|record| &record.measured), Some(&measured));
        assert!(store.find(&setting(2)).is_none() && open(true).unwrap().find(&setting(1)).is_none());
        open(true).unwrap().add(ViscosityRecord { setting: setting(1), measured: measured.clone() }).unwrap();
        let whole = fs::read_to_string(folder.join("viscosity.json")).unwrap();
        fs::write(folder.join("viscosity.json"), whole.replacen("1.25", "1.5", 1)).unwrap();
        let refusal = open(false).err().unwrap().to_string();
        assert!(refusal.contains("record 1 of its viscosity.json is not as it was measured"), "{refusal}");
        // as earlier versions wrote it
        let mut earlier: serde_json::Value = serde_json::from_str(&whole).unwrap();
        assert!(earlier.as_object_mut().unwrap().remove("checksums").is_some());
        fs::write(folder.join("viscosity.json"), earlier.to_string()).unwrap();
        assert!(open(false).unwrap().find(&setting(1)).is_some());
        fs::write(folder.join("viscosity.json"), "{").unwrap();
        let refusal = open(false).err().unwrap().to_string();
        assert!(refusal.contains("start anew with --fresh"), "{refusal}");
        fs::remove_dir_all(&folder).unwrap();
    }
}
