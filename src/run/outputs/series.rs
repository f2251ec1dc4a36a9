//! `series.csv`: a row of numbers for each step, complete lines only; an effect that the scene does not call for has no column.

use std::{
    fs::{self, File, OpenOptions},
    io::Write,
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
    time::Instant,
};

use crate::{
    contact::Solver,
    error::{Error, Offer, Refusal, Result},
    observe::{InertialNumbers, Viscosity},
    output::{CurvePoint, Summary, not_finite, note, write_whole},
    parallel::World,
    run::{ContactTotals, Evaluated, EvaluatedFlow, EvaluatedMotion, Output},
    scene::ContactModel,
};

/// The name and the text of a cell; one without a number is empty.
type Cell = (&'static str, String);

/// The series of a run.
pub struct SeriesFile {
    folder: PathBuf,
    /// On the first rank.
    rows: Option<Rows>,
    last_row: Instant,
}

/// The file, open for further rows.
struct Rows {
    path: PathBuf,
    file: File,
    /// Length of what was written.
    length: u64,
}

impl SeriesFile {
    /// Opens it for the rows from `step` on, and gives the viscosity of those before it. Collective.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be read or written; [`Error::Refused`] when it is not one of ours.
    pub fn open(world: &World, folder: &Path, step: usize) -> Result<(SeriesFile, Vec<CurvePoint>)> {
        let opened = world.on_first_rank(|| Rows::open(folder, step).map(Some))?;
        let (rows, kept, lost) = opened.map_or((None, String::new(), None), |(rows, kept, lost)| (Some(rows), kept, lost));
        lost.iter().for_each(|lost| note(&format!("turbid: {lost}")));
        Ok((SeriesFile { folder: folder.to_owned(), rows, last_row: Instant::now() }, CurvePoint::read(&kept)))
    }
}

impl<const D: usize> Output<D> for SeriesFile {
    fn write(&mut self, seen: &Evaluated<D>) -> Result<()> {
        let Some(motion) = &seen.motion else { return Ok(()) };
        let seconds = std::mem::replace(&mut self.last_row, Instant::now()).elapsed().as_secs_f64();
        let totals = motion.contact_totals(seen.world);
        let mut row = cells(motion, (seen.scene.contact.model, totals), seen.viscosity);
        row.extend(seen.flow.map_or(Ok(Vec::new()), |flow| of_inertia(&flow, motion.state().last_step))?);
        row.push(real("seconds", seconds));
        seen.world.agree(self.rows.as_mut().map_or(Ok(()), |rows| rows.write(&row)))
    }

    fn finish(&mut self, seen: &Evaluated<D>, _: &mut Summary) -> Result<Vec<String>> {
        seen.world.agree(self.rows.as_ref().map_or(Ok(()), Rows::refuse_change))?;
        Ok(vec!["series.csv".to_owned()].into_iter().filter(|name| self.folder.join(name).exists()).collect())
    }
}

/// The cells of a flow with inertia after a step; none without inertia. Collective.
fn of_inertia<const D: usize>(flow: &EvaluatedFlow<D>, step: f64) -> Result<Vec<Cell>> {
    let (setup, grid) = (flow.solver.setup(), flow.solver.grid());
    let cells = |numbers: InertialNumbers| {
        vec![
            real("kinetic_energy", numbers.kinetic_energy),
            real("reynolds", numbers.reynolds),
            real("courant", numbers.courant(grid, step)),
        ]
    };
    Ok(InertialNumbers::of(setup, grid, flow.solution)?.map(cells).unwrap_or_default())
}

/// The cells of the row of an instant and of the step that led there.
fn cells<const D: usize>(
    motion: &EvaluatedMotion<D>,
    (contact, totals): (ContactModel, ContactTotals),
    viscosity: Option<Viscosity>,
) -> Vec<Cell> {
    let (state, last) = (motion.state(), motion.statistics.last());
    let mut cells = vec![count("step", state.steps), real("time", state.time), real("last_step", state.last_step)];
    if let Some(viscosity) = viscosity {
        let point = CurvePoint::of(&viscosity, state.time, contact != ContactModel::None);
        cells.extend(point.columns().into_iter().map(|(name, value)| real(name, value)));
        cells.extend(viscosity.from_walls.map(|walls| real("viscosity_from_walls", walls)));
    }
    if contact != ContactModel::None {
        let kept = last.and_then(|last| last.kkt_report);
        cells.push(count("contacts", totals.held));
        cells.extend(contact.gluey().then(|| count("stuck", totals.stuck)));
        cells.push(gap(kept.map_or(f64::INFINITY, |kept| kept.smallest_gap)));
        if matches!(contact, ContactModel::Inelastic | ContactModel::Gluey { .. }) {
            cells.push(real("kkt_residual", kept.map_or(0.0, |kept| kept.kkt_residual)));
            cells.push(real("contact_force", kept.map_or(0.0, |kept| kept.total_force)));
            cells.push(count("contact_iterations", kept.map_or(0, |kept| kept.iterations)));
            // 0 by a formula, 1 along the sparse central path, 2 by the general interior point
            cells.push(count("contact_solver", kept.map_or(Solver::Formula, |kept| kept.solver) as usize));
        }
    }
    if motion.observation.solution.is_some() {
        let effort = motion.observation.effort + last.map_or_else(Default::default, |last| last.effort);
        cells.extend([count("solves", effort.solves), count("iterations", effort.iterations)]);
    }
    cells
}

fn count(name: &'static str, count: usize) -> Cell {
    (name, count.to_string())
}

/// The shortest text that reads back as the number.
fn real(name: &'static str, value: f64) -> Cell {
    (name, format!("{value:?}"))
}

/// Readers of CSV take an empty cell for a number that is not there, but few know infinity.
fn gap(value: f64) -> Cell {
    if value == f64::INFINITY { ("smallest_gap", String::new()) } else { real("smallest_gap", value) }
}

/// Refuses a row of which a number is not finite; an empty cell has none.
fn check(cells: &[Cell]) -> Result<()> {
    let value = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let broken = cells.iter().find(|(_, text)| !text.is_empty() && !value(text).is_finite());
    broken.map_or(Ok(()), |(name, text)| Err(not_finite("series.csv", name, value(text))))
}

impl Rows {
    /// Opens the file for the rows from `step` on: those before it stay and are given back, the others go. Says what is missing, if rows are.
    fn open(folder: &Path, step: usize) -> Result<(Rows, String, Option<String>)> {
        let path = folder.join("series.csv");
        let (kept, note) = if step > 0 { rows_before(&path, step)? } else { (String::new(), None) };
        write_whole(&path, kept.as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path).map_err(|source| Error::File { path: path.clone(), source })?;
        Ok((Rows { path, file, length: kept.len() as u64 }, kept, note))
    }

    /// Adds a row, and the names of the columns before the first one.
    fn write(&mut self, cells: &[Cell]) -> Result<()> {
        check(cells)?;
        let mut text = cells.iter().map(|(_, value)| value.as_str()).collect::<Vec<_>>().join(",") + "\n";
        if self.length == 0 {
            text = cells.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",") + "\n" + &text;
        }
        self.refuse_change()?;
        // one call a row: what a kill leaves is a whole line or nothing
        self.file.write_all(text.as_bytes()).map_err(|source| Error::File { path: self.path.clone(), source })?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Refuses a file that is no longer there, or no longer holds the rows so far and nothing else.
    fn refuse_change(&self) -> Result<()> {
        let of = |metadata: fs::Metadata| (metadata.dev(), metadata.ino(), metadata.len());
        let own = self.file.metadata().map_err(|source| Error::File { path: self.path.clone(), source })?;
        let (path, folder) = (self.path.display(), self.path.parent().unwrap_or(Path::new("")));
        let what = match fs::metadata(&self.path).map(of) {
            Ok(there) if there == (own.dev(), own.ino(), self.length) => return Ok(()),
            Ok(_) => "was changed",
            Err(_) => "was removed",
        };
        let remedy = format!("{path}: {what} while the run went on, which no longer adds to it; put it back");
        Err(Refusal::from(remedy).offering(Offer::ThenResume(folder.to_owned())))
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
        Error::refused(format!("{path}:{line}: is no row of a series; put the file back, or remove it to go on without the rows so far"))
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

    fn point(step: usize) -> CurvePoint {
        let normal = NormalStresses { first: -0.5, second: None, pressure: Some(0.25), contact_pressure: 0.125 };
        let viscosity = Viscosity {
            rate: 1.0,
            hydrodynamic: 1.5,
            lubrication: None,
            interaction: None,
            reynolds: None,
            contact: 0.25,
            normal,
            from_walls: None,
        };
        CurvePoint::of(&viscosity, 0.1 * step as f64, false)
    }

    fn row(step: usize) -> Vec<Cell> {
        let viscosity = point(step).columns().into_iter().map(|(name, value)| real(name, value));
        [count("step", step), real("time", 0.1 * step as f64)].into_iter().chain(viscosity).chain([real("seconds", 0.5)]).collect()
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
        let (mut rows, kept, note) = Rows::open(&folder, 3).unwrap();
        assert_eq!(note, None);
        let written: Vec<CurvePoint> = (0..3).map(point).collect();
        assert_eq!(CurvePoint::read(&kept), written, "what is read back is not what was written");
        (3..5).for_each(|step| rows.write(&row(step)).unwrap());
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap(), whole);
        fs::write(folder.join("series.csv"), "header\nnonsense\n").unwrap();
        assert!(matches!(Rows::open(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_gap_that_is_not_there_is_an_empty_cell() {
        assert_eq!([f64::INFINITY, 0.25].map(|value| gap(value).1), ["", "0.25"]);
        assert!(check(&[gap(f64::INFINITY)]).is_ok() && check(&[real("time", f64::INFINITY)]).is_err());
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
            assert!(refusal.contains("series.csv") && refusal.contains(what) && refusal.contains("put it back, then go on"), "{refusal}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_run_goes_on_without_rows_that_are_lost_and_says_so() {
        let folder = folder("lost");
        let note = Rows::open(&folder, 3).unwrap().2.unwrap();
        assert!(note.ends_with("series.csv: 3 of the 3 rows before step 3 are missing"), "{note}");
        let mut rows = Rows::open(&folder, 0).unwrap().0;
        (0..2).for_each(|step| rows.write(&row(step)).unwrap());
        let (mut rows, _, note) = Rows::open(&folder, 4).unwrap();
        assert!(note.unwrap().contains("2 of the 4 rows"));
        rows.write(&row(4)).unwrap();
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap().lines().count(), 4);
        fs::write(folder.join("series.csv"), b"step,\xff\n\xff\n").unwrap();
        assert!(matches!(Rows::open(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }
}
