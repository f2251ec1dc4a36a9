//! `series.csv`: a row of numbers for each step, complete lines only.

use std::{
    fs::{self, File, OpenOptions},
    io::Write,
    path::{Path, PathBuf},
};

use super::write_whole;
use crate::{
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
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactNumbers {
    /// Contacts that bear a force.
    pub active: usize,
    /// Contacts that stick, if contacts are gluey.
    pub stuck: Option<usize>,
    /// Smallest gap in radii of the smaller body, infinite if no two are near each other.
    pub smallest_gap: f64,
    /// If velocities are projected: residual of the optimality conditions, and iterations of the interior-point method on the
    /// island that took most.
    pub projection: Option<(f64, usize)>,
}

/// The file, open for further rows. Only the first rank has one.
pub struct Rows {
    path: PathBuf,
    file: File,
    /// Rows so far: strain and parts of the viscosity.
    curve: Vec<(f64, f64, f64)>,
}

impl Row {
    fn cells(&self) -> Vec<(&'static str, String)> {
        let mut cells = vec![("step", self.step.to_string()), ("time", number(self.time)), ("last_step", number(self.last_step))];
        if let Some(viscosity) = &self.viscosity {
            cells.push(("strain", number(viscosity.rate * self.time)));
            cells.push(("viscosity", number(viscosity.relative())));
            cells.push(("viscosity_hydrodynamic", number(viscosity.hydrodynamic)));
            if self.contact.is_some() {
                cells.push(("viscosity_contact", number(viscosity.contact)));
            }
            if let Some(walls) = viscosity.from_walls {
                cells.push(("viscosity_from_walls", number(walls)));
            }
        }
        if let Some(contact) = &self.contact {
            cells.push(("contacts", contact.active.to_string()));
            cells.extend(contact.stuck.map(|stuck| ("stuck", stuck.to_string())));
            cells.push(("smallest_gap", number(contact.smallest_gap)));
            if let Some((residual, iterations)) = contact.projection {
                cells.push(("kkt_residual", number(residual)));
                cells.push(("contact_iterations", iterations.to_string()));
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

/// The shortest text that reads back as the number.
fn number(value: f64) -> String {
    format!("{value:?}")
}

impl Rows {
    /// Opens the file for the rows from `step` on: those before it stay, the others go.
    ///
    /// # Errors
    /// [`Error::File`], here and below, when the file cannot be read or written; [`Error::Refused`] when it is not one of ours.
    pub fn open(folder: &Path, step: usize) -> Result<Rows> {
        let path = folder.join("series.csv");
        let kept = if step > 0 { rows_before(&path, step)? } else { String::new() };
        write_whole(&path, kept.as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path).map_err(|source| Error::File { path: path.clone(), source })?;
        Ok(Rows { curve: curve(&kept), path, file })
    }

    /// Adds a row, and the names of the columns before the first one.
    pub fn write(&mut self, row: &Row) -> Result<()> {
        let cells = row.cells();
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let mut text = line(cells.iter().map(|(_, value)| value.clone()).collect());
        let empty = self.file.metadata().is_ok_and(|metadata| metadata.len() == 0);
        if empty {
            text = line(cells.iter().map(|(name, _)| (*name).to_owned()).collect()) + &text;
        }
        if let Some(viscosity) = &row.viscosity {
            self.curve.push((viscosity.rate * row.time, viscosity.hydrodynamic, viscosity.contact));
        }
        // one call a row: what a kill leaves is a whole line or nothing
        self.file.write_all(text.as_bytes()).map_err(|source| Error::File { path: self.path.clone(), source })
    }

    /// Strain, hydrodynamic and contact part of the viscosity of all rows.
    pub fn curve(&self) -> &[(f64, f64, f64)] {
        &self.curve
    }
}

/// The header and the whole rows whose number is below `step`.
fn rows_before(path: &Path, step: usize) -> Result<String> {
    let text = fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
    let refuse = |line: usize| {
        let path = path.display();
        Error::Refused(format!("{path}:{line}: is no row of a series; restore the file or resume from a copy of the folder"))
    };
    let mut kept = String::new();
    for (number, line) in text.split_inclusive('\n').enumerate().filter(|(_, line)| line.ends_with('\n')) {
        let row = line.split(',').next().and_then(|cell| cell.parse::<usize>().ok());
        match row {
            None if number > 0 => return Err(refuse(number + 1)),
            Some(row) if row >= step => break,
            _ => kept.push_str(line),
        }
    }
    Ok(kept)
}

/// Strain and parts of the viscosity in the rows of a text, if it has them.
fn curve(text: &str) -> Vec<(f64, f64, f64)> {
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap_or_default();
    let columns = ["strain", "viscosity_hydrodynamic", "viscosity_contact"].map(|name| header.iter().position(|column| *column == name));
    let [Some(strain), Some(hydrodynamic), contact] = columns else { return Vec::new() };
    let number = |line: &[&str], column: usize| line.get(column).and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN);
    let of_contacts = |line: &[&str]| contact.map_or(0.0, |contact| number(line, contact));
    lines.map(|line| (number(&line, strain), number(&line, hydrodynamic), of_contacts(&line))).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn row(step: usize) -> Row {
        let time = 0.1 * step as f64;
        let viscosity = Some(Viscosity { rate: 1.0, hydrodynamic: 1.5, contact: 0.25, from_walls: None });
        Row { step, time, last_step: 0.1, viscosity, contact: None, flow: true, effort: Effort::default(), seconds: 0.5 }
    }

    #[test]
    fn a_series_goes_on_where_a_run_was_resumed_and_drops_half_rows() {
        let folder = std::env::temp_dir().join(format!("turbid-series-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let mut rows = Rows::open(&folder, 0).unwrap();
        (0..5).for_each(|step| rows.write(&row(step)).unwrap());
        let whole = fs::read_to_string(folder.join("series.csv")).unwrap();
        fs::write(folder.join("series.csv"), format!("{whole}5,0.5")).unwrap();
        let mut rows = Rows::open(&folder, 3).unwrap();
        assert_eq!(rows.curve().len(), 3);
        (3..5).for_each(|step| rows.write(&row(step)).unwrap());
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap(), whole);
        assert!(!whole.contains("contacts"), "an effect that is off has a column");
        fs::write(folder.join("series.csv"), "header\nnonsense\n").unwrap();
        assert!(matches!(Rows::open(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }
}
