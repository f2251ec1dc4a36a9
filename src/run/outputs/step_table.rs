//! Tables of a run in time: a row of numbers for each step, complete lines only, which a run that goes on continues.

use std::{
    borrow::Cow,
    fs::{self, File, OpenOptions},
    io::Write,
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
};

use crate::{
    error::{Error, Offer, Refusal, Result},
    output::{not_finite, note, write_whole},
    parallel::World,
};

/// The name and the text of a cell; one without a number is empty.
pub type Cell = (Cow<'static, str>, String);

/// A whole number.
pub fn count(name: impl Into<Cow<'static, str>>, count: usize) -> Cell {
    (name.into(), count.to_string())
}

/// The shortest text that reads back as the number.
pub fn real(name: impl Into<Cow<'static, str>>, value: f64) -> Cell {
    (name.into(), format!("{value:?}"))
}

/// A number that is not there.
pub fn absent(name: impl Into<Cow<'static, str>>) -> Cell {
    (name.into(), String::new())
}

/// A table, open for further rows.
pub struct StepTable {
    path: PathBuf,
    file: File,
    /// Length of what was written.
    length: u64,
}

/// A table that goes on.
pub struct Begun {
    /// The table.
    pub table: StepTable,
    /// Its header and rows so far.
    pub kept: String,
    /// What is missing of them.
    pub lost: Option<String>,
}

impl StepTable {
    /// Opens a file for the rows from `step` on, on the first rank, and gives those before it; says which are missing. Collective.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be read or written; [`Error::Refused`] when it is not one of ours.
    pub fn open(world: &World, path: &Path, step: usize) -> Result<(Option<StepTable>, String)> {
        let begun = world.on_first_rank(|| StepTable::begin(path, step).map(Some))?;
        let Some(Begun { table, kept, lost }) = begun else { return Ok((None, String::new())) };
        lost.iter().for_each(|lost| note(&format!("turbid: {lost}")));
        Ok((Some(table), kept))
    }

    /// The same on one rank alone: those rows stay, the others go.
    pub fn begin(path: &Path, step: usize) -> Result<Begun> {
        let (kept, lost) = if step > 0 { rows_before(path, step)? } else { (String::new(), None) };
        write_whole(path, kept.as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        Ok(Begun { table: StepTable { path: path.to_owned(), file, length: kept.len() as u64 }, kept, lost })
    }

    /// Adds a row, and the names of the columns before the first one.
    ///
    /// # Errors
    /// A number is not finite, the file cannot be written, or another hand has changed it.
    pub fn write(&mut self, cells: &[Cell]) -> Result<()> {
        check(&self.path, cells)?;
        let mut text = cells.iter().map(|(_, value)| value.as_str()).collect::<Vec<_>>().join(",") + "\n";
        if self.length == 0 {
            text = cells.iter().map(|(name, _)| name.as_ref()).collect::<Vec<_>>().join(",") + "\n" + &text;
        }
        self.refuse_change()?;
        // one call a row: what a kill leaves is a whole line or nothing
        self.file.write_all(text.as_bytes()).map_err(|source| Error::File { path: self.path.clone(), source })?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Refuses a file that is no longer there, or no longer holds the rows so far and nothing else.
    pub fn refuse_change(&self) -> Result<()> {
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

/// Refuses a row of which a number is not finite; an empty cell has none.
fn check(path: &Path, cells: &[Cell]) -> Result<()> {
    let value = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let broken = cells.iter().find(|(_, text)| !text.is_empty() && !value(text).is_finite());
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    broken.map_or(Ok(()), |(name, text)| Err(not_finite(&file, name, value(text))))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn begin(folder: &Path, step: usize) -> Result<Begun> {
        StepTable::begin(&folder.join("series.csv"), step)
    }

    fn row(step: usize) -> Vec<Cell> {
        vec![count("step", step), real("time", 0.1 * step as f64), absent("smallest_gap"), real("seconds", 0.5)]
    }

    #[test]
    fn a_number_that_is_not_there_passes_and_one_that_is_not_finite_does_not() {
        let path = Path::new("out/series.csv");
        assert!(check(path, &row(3)).is_ok());
        let refusal = check(path, &[real("time", f64::INFINITY)]).unwrap_err().to_string();
        assert!(refusal.contains("series.csv") && refusal.contains("time"), "{refusal}");
    }

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("turbid-series-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_series_goes_on_where_a_run_was_resumed_and_drops_half_rows() {
        let folder = folder("resumed");
        let mut rows = begin(&folder, 0).unwrap().table;
        (0..5).for_each(|step| rows.write(&row(step)).unwrap());
        let whole = fs::read_to_string(folder.join("series.csv")).unwrap();
        fs::write(folder.join("series.csv"), format!("{whole}5,0.5")).unwrap();
        let Begun { table: mut rows, kept, lost: note } = begin(&folder, 3).unwrap();
        assert_eq!(note, None);
        assert_eq!(kept, whole.split_inclusive('\n').take(4).collect::<String>());
        (3..5).for_each(|step| rows.write(&row(step)).unwrap());
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap(), whole);
        fs::write(folder.join("series.csv"), "header\nnonsense\n").unwrap();
        assert!(matches!(begin(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
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
            let mut rows = begin(&folder, 0).unwrap().table;
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
        let note = begin(&folder, 3).unwrap().lost.unwrap();
        assert!(note.ends_with("series.csv: 3 of the 3 rows before step 3 are missing"), "{note}");
        let mut rows = begin(&folder, 0).unwrap().table;
        (0..2).for_each(|step| rows.write(&row(step)).unwrap());
        let Begun { table: mut rows, lost: note, .. } = begin(&folder, 4).unwrap();
        assert!(note.unwrap().contains("2 of the 4 rows"));
        rows.write(&row(4)).unwrap();
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap().lines().count(), 4);
        fs::write(folder.join("series.csv"), b"step,\xff\n\xff\n").unwrap();
        assert!(matches!(begin(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }
}
