//! What a run ends with.

use std::path::PathBuf;

use crate::output::{CurvePoint, Summary, report, sparkline};

/// The result of a run.
pub struct Finished {
    /// Its numbers.
    pub summary: Summary,
    /// The viscosity over time; on the first rank.
    pub curve: Vec<CurvePoint>,
    /// Its output folder, if it has one.
    pub folder: Option<PathBuf>,
    /// Names of the files in it.
    pub files: Vec<String>,
}

impl Finished {
    /// The result in a few lines for people.
    pub fn text(&self) -> String {
        let line = sparkline(self.curve.iter().map(CurvePoint::relative)).map(|line| format!("\nviscosity over time  {line}"));
        let files = self.folder.as_ref().map(|folder| format!("\nfiles                {}: {}", folder.display(), self.files.join(", ")));
        report(&self.summary) + &line.unwrap_or_default() + &files.unwrap_or_default()
    }
}
