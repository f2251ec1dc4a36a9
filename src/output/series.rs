//! `series.csv`: a row of numbers for each step, complete lines only.

use std::{
    fs::{self, File, OpenOptions},
    io::Write,
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
};

use super::{CurvePoint, finite::not_finite, write_whole};
use crate::{
    contact::Solver,
    error::{Error, Result},
    observe::Viscosity,
    simulation::Effort,
};

/// The numbers of one step; an effect that the scene does not call for has no column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Steps made so far.
    pub step: usize,
    /// Time.
    pub time: f64,
    /// Length of the step that led here.
    pub last_step: f64,
    /// Apparent viscosity, in a sheared suspension.
    pub viscosity: Option<Viscosity>,
    /// Contacts, if a contact model acts.
    pub contact: Option<ContactNumbers>,
    /// Solves of the flow, if there is one.
    pub flow: bool,
    /// What the step that led here and the look at this instant cost.
    pub effort: Effort,
    /// Wall-clock seconds since the last row.
    pub seconds: f64,
}

/// Contacts at an instant, and how well they were kept in the step that led there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactNumbers {
    /// Contacts that bear a force.
    pub active: usize,
    /// Contacts that stick, if contacts are gluey.
    pub stuck: Option<usize>,
    /// Smallest gap in radii of the smaller body, infinite (an empty cell) if no two are near each other and at the start.
    pub smallest_gap: f64,
    /// If velocities are projected, how.
    pub projection: Option<ProjectionNumbers>,
}

/// How velocities were projected in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProjectionNumbers {
    /// Residual of the optimality conditions.
    pub kkt_residual: f64,
    /// Sum of all contact forces that were found in that step.
    pub total_force: f64,
    /// Iterations of the contact solver on the island that took most.
    pub iterations: usize,
    /// The contact solver: 0 by a formula, 1 along the sparse central path, 2 by the general interior point.
    pub solver: Solver,
}

/// The file, open for further rows. Only the first rank has one.
pub struct Rows {
    path: PathBuf,
    file: File,
    /// Length of what was written.
    length: u64,
    /// The viscosity of the rows so far.
    curve: Vec<CurvePoint>,
}

impl Row {
    fn point(&self) -> Option<CurvePoint> {
        self.viscosity.map(|viscosity| CurvePoint::of(&viscosity, self.time, self.contact.is_some()))
    }

    fn cells(&self) -> Vec<(&'static str, String)> {
        let mut cells = vec![("step", self.step.to_string()), ("time", number(self.time)), ("last_step", number(self.last_step))];
        if let Some(point) = self.point() {
            cells.extend(point.columns().into_iter().map(|(name, value)| (name, number(value))));
        }
        if let Some(walls) = self.viscosity.and_then(|viscosity| viscosity.from_walls) {
            cells.push(("viscosity_from_walls", number(walls)));
        }
        if let Some(contact) = &self.contact {
            cells.push(("contacts", contact.active.to_string()));
            cells.extend(contact.stuck.map(|stuck| ("stuck", stuck.to_string())));
            // readers of CSV take an empty cell for a number that is not there, but few know infinity
            cells.push(("smallest_gap", if contact.smallest_gap == f64::INFINITY { String::new() } else { number(contact.smallest_gap) }));
            if let Some(projection) = contact.projection {
                cells.push(("kkt_residual", number(projection.kkt_residual)));
                cells.push(("contact_force", number(projection.total_force)));
                cells.push(("contact_iterations", projection.iterations.to_string()));
                cells.push(("contact_solver", (projection.solver as u8).to_string()));
            }
        }
        if self.flow {
            cells.push(("solves", self.effort.solves.to_string()));
            cells.push(("iterations", self.effort.iterations.to_string()));
        }
        cells.push(("seconds", number(self.seconds)));
        cells
    }
}

/// Refuses a row of which a number is not finite; an empty cell has none.
fn check(cells: &[(&'static str, String)]) -> Result<()> {
    let value = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let broken = cells.iter().find(|(_, text)| !text.is_empty() && !value(text).is_finite());
    broken.map_or(Ok(()), |(name, text)| Err(not_finite("series.csv", name, value(text))))
}

/// The shortest text that reads back as the number.
fn number(value: f64) -> String {
    format!("{value:?}")
}

impl Rows {
    /// Opens the file for the rows from `step` on: those before it stay, the others go. Says what is missing, if rows are.
    ///
    /// # Errors
    /// [`Error::File`], here and below, when the file cannot be read or written; [`Error::Refused`] when it is not one of ours.
    pub fn open(folder: &Path, step: usize) -> Result<(Rows, Option<String>)> {
        let path = folder.join("series.csv");
        let (kept, note) = if step > 0 { rows_before(&path, step)? } else { (String::new(), None) };
        write_whole(&path, kept.as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path).map_err(|source| Error::File { path: path.clone(), source })?;
        Ok((Rows { curve: CurvePoint::read(&kept), path, file, length: kept.len() as u64 }, note))
    }

    /// Adds a row, and the names of the columns before the first one.
    pub fn write(&mut self, row: &Row) -> Result<()> {
        let cells = row.cells();
        check(&cells)?;
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let mut text = line(cells.iter().map(|(_, value)| value.clone()).collect());
        if self.length == 0 {
            text = line(cells.iter().map(|(name, _)| (*name).to_owned()).collect()) + &text;
        }
        self.curve.extend(row.point());
        self.refuse_change()?;
        // one call a row: what a kill leaves is a whole line or nothing
        self.file.write_all(text.as_bytes()).map_err(|source| Error::File { path: self.path.clone(), source })?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Refuses a file that is no longer there, or no longer holds the rows so far and nothing else.
    ///
    /// # Errors
    /// [`Error::Refused`].
    pub fn refuse_change(&self) -> Result<()> {
        let of = |metadata: fs::Metadata| (metadata.dev(), metadata.ino(), metadata.len());
        let own = self.file.metadata().map_err(|source| Error::File { path: self.path.clone(), source })?;
        let (path, folder) = (self.path.display(), self.path.parent().unwrap_or(Path::new("")).display());
        let what = match fs::metadata(&self.path).map(of) {
            Ok(there) if there == (own.dev(), own.ino(), self.length) => return Ok(()),
            Ok(_) => "was changed",
            Err(_) => "was removed",
        };
        Err(Error::Refused(format!(
            "{path}: {what} while the run went on, which no longer adds to it; put it back, then `turbid resume {folder}` goes on from the last checkpoint"
        )))
    }

    /// The viscosity of all rows.
    pub fn curve(&self) -> &[CurvePoint] {
        &self.curve
    }
}

/// The header and the whole rows whose number is below `step`, and what is missing of them.
fn rows_before(path: &Path, step: usize) -> Result<(String, Option<String>)> {
    let lost = |kept: usize| format!("{}: {} of the {step} rows before step {step} are missing", path.display(), step - kept);
    let bytes = match fs::read(path) {
        Err(source) if source.kind() == std::io::ErrorKind::NotFound => return Ok((String::new(), Some(lost(0)))),
        bytes => bytes.map_err(|source| Error::File { path: path.to_owned(), source })?,
    };
    let text = String::from_utf8_lossy(&bytes);
    let refuse = |line: usize| {
        let path = path.display();
        Error::Refused(format!("{path}:{line}: is no row of a series; put the file back, or remove it to go on without the rows so far"))
    };
    let (mut kept, mut rows) = (String::new(), 0);
    for (number, line) in text.split_inclusive('\n').enumerate().filter(|(_, line)| line.ends_with('\n')) {
        let row = line.split(',').next().and_then(|cell| cell.parse::<usize>().ok());
        match row {
            None if number > 0 => return Err(refuse(number + 1)),
            Some(row) if row >= step => break,
            _ => kept.push_str(line),
        }
        rows += usize::from(row.is_some());
    }
    Ok((kept, (rows < step).then(|| lost(rows))))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::observe::NormalStresses;

    fn row(step: usize) -> Row {
        let time = 0.1 * step as f64;
        let normal = NormalStresses { first: -0.5, second: None, pressure: Some(0.25), contact_pressure: 0.125 };
        let viscosity =
            Some(Viscosity { rate: 1.0, hydrodynamic: 1.5, lubrication: None, interaction: None, contact: 0.25, normal, from_walls: None });
        Row { step, time, last_step: 0.1, viscosity, contact: None, flow: true, effort: Effort::default(), seconds: 0.5 }
    }

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("turbid-series-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_series_goes_on_where_a_run_was_resumed_and_drops_half_rows() {
        let folder = folder("resumed");
        let mut rows = Rows::open(&folder, 0).unwrap().0;
        (0..5).for_each(|step| rows.write(&row(step)).unwrap());
        let whole = fs::read_to_string(folder.join("series.csv")).unwrap();
        fs::write(folder.join("series.csv"), format!("{whole}5,0.5")).unwrap();
        let (mut rows, note) = Rows::open(&folder, 3).unwrap();
        assert_eq!(note, None);
        assert_eq!(rows.curve().len(), 3);
        (3..5).for_each(|step| rows.write(&row(step)).unwrap());
        let written: Vec<CurvePoint> = (0..5).map(|step| row(step).point().unwrap()).collect();
        assert_eq!(rows.curve(), written, "what is read back is not what was written");
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap(), whole);
        assert!(!whole.contains("contacts"), "an effect that is off has a column");
        fs::write(folder.join("series.csv"), "header\nnonsense\n").unwrap();
        assert!(matches!(Rows::open(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_gap_that_is_not_there_is_an_empty_cell() {
        let projection = ProjectionNumbers { kkt_residual: 0.0, total_force: 0.0, iterations: 0, solver: Solver::Formula };
        let contact = |smallest_gap| ContactNumbers { active: 0, stuck: None, smallest_gap, projection: Some(projection) };
        let line = |gap| {
            let cells = Row { contact: Some(contact(gap)), ..row(0) }.cells();
            cells.into_iter().find(|(name, _)| *name == "smallest_gap").unwrap().1
        };
        assert_eq!((line(f64::INFINITY).as_str(), line(0.25).as_str()), ("", "0.25"));
    }

    /// How a file is lost.
    type Lose = fn(&Path);

    #[test]
    fn a_series_that_another_hand_changes_is_noticed() {
        let folder = folder("changed");
        let path = folder.join("series.csv");
        let lose: [(&str, Lose); 4] = [
            ("was removed", |path| fs::remove_file(path).unwrap()),
            ("was changed", |path| OpenOptions::new().write(true).open(path).unwrap().set_len(20).unwrap()),
            ("was changed", |path| {
                let text = fs::read(path).unwrap();
                fs::remove_file(path).unwrap();
                fs::write(path, text).unwrap();
            }),
            ("was changed", |path| OpenOptions::new().append(true).open(path).unwrap().write_all(b"7,7\n").unwrap()),
        ];
        for (what, lose) in lose {
            let mut rows = Rows::open(&folder, 0).unwrap().0;
            (0..3).for_each(|step| rows.write(&row(step)).unwrap());
            lose(&path);
            let refusal = rows.write(&row(3)).unwrap_err().to_string();
            assert!(refusal.contains("series.csv") && refusal.contains(what) && refusal.contains("turbid resume"), "{refusal}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_run_goes_on_without_rows_that_are_lost_and_says_so() {
        let folder = folder("lost");
        let note = Rows::open(&folder, 3).unwrap().1.unwrap();
        assert!(note.ends_with("series.csv: 3 of the 3 rows before step 3 are missing"), "{note}");
        let mut rows = Rows::open(&folder, 0).unwrap().0;
        (0..2).for_each(|step| rows.write(&row(step)).unwrap());
        let (mut rows, note) = Rows::open(&folder, 4).unwrap();
        assert!(note.unwrap().contains("2 of the 4 rows"));
        rows.write(&row(4)).unwrap();
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap().lines().count(), 4);
        fs::write(folder.join("series.csv"), b"step,\xff\n\xff\n").unwrap();
        assert!(matches!(Rows::open(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }
}
