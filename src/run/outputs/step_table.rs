//! Tables of a run in time: a row of numbers for each step, complete lines only, which a run that goes on continues.
//!
//! The first row names the columns. Every later one is laid out by these names: a number that is not there leaves its cell empty, and one that has no
//! column is an error, so that no cell is ever under the name of another. Each line has a checksum, which a run that goes on compares.

use std::{
    fs::{self, File, OpenOptions},
    io::Write,
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
};

use super::cell::{Cell, refuse_infinite};
use super::checksums::{Checksums, verify};
use super::kept_rows::kept_lines;
use crate::{
    error::{Error, Offer, Refusal, Result},
    output::{column_names, note, write_whole},
    parallel::World,
};

/// A table, open for further rows.
pub struct StepTable {
    path: PathBuf,
    file: File,
    sums: Checksums,
    /// Length of what was written.
    length: u64,
    /// Names of the columns; none before the first row.
    names: Vec<String>,
    /// Whether the header was begun by another program, whose columns must be those of this one.
    inherited: bool,
}

/// A table that goes on.
pub struct Begun {
    /// The table.
    pub table: StepTable,
    /// Its header and rows so far.
    pub kept: String,
    /// What is missing of them.
    pub lost: Vec<String>,
}

impl StepTable {
    /// Opens a file for the rows from `step` on, on the first rank, and gives those before it; says which are missing. Collective.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be read or written; [`Error::Refused`] when it is not one of ours, or was changed.
    pub fn open(world: &World, path: &Path, step: usize) -> Result<(Option<StepTable>, String)> {
        StepTable::opened(world, || StepTable::begin(path, step))
    }

    /// The same of a table with several rows for each time, which stand in its first column: those before `time` stay. Collective.
    ///
    /// # Errors
    /// As [`open`](StepTable::open).
    pub fn open_before(world: &World, path: &Path, time: f64) -> Result<(Option<StepTable>, String)> {
        StepTable::opened(world, || StepTable::go_on(path, kept_lines(path, &|first| first < time)?.0))
    }

    fn opened(world: &World, begin: impl FnOnce() -> Result<Begun>) -> Result<(Option<StepTable>, String)> {
        let Some(Begun { table, kept, lost }) = world.on_first_rank(|| begin().map(Some))? else { return Ok((None, String::new())) };
        lost.iter().for_each(|lost| note(&format!("turbid: {lost}")));
        Ok((Some(table), kept))
    }

    /// The same on one rank alone: those rows stay, the others go.
    pub fn begin(path: &Path, step: usize) -> Result<Begun> {
        let (kept, rows) = kept_lines(path, &|first| first < step as f64)?;
        let lost = || format!("{}: {} of the {step} rows before step {step} are missing", path.display(), step - rows);
        let missing = (rows < step).then(lost);
        let Begun { table, kept, lost } = StepTable::go_on(path, kept)?;
        Ok(Begun { table, kept, lost: missing.into_iter().chain(lost).collect() })
    }

    fn go_on(path: &Path, kept: String) -> Result<Begun> {
        let unchecked = verify(path, &kept)?;
        let sums = Checksums::begin(path, &kept)?;
        write_whole(path, kept.as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        let names = kept.lines().next().map_or(Vec::new(), column_names);
        let (inherited, length) = (!names.is_empty(), kept.len() as u64);
        let table = StepTable { path: path.to_owned(), file, sums, length, names, inherited };
        Ok(Begun { table, kept, lost: unchecked.into_iter().collect() })
    }

    /// Adds a row, and the names of the columns before the first one.
    ///
    /// # Errors
    /// A number is not finite or has no column, the file cannot be written, or another hand has changed it.
    pub fn write(&mut self, cells: &[Cell]) -> Result<()> {
        self.write_rows(&[cells])
    }

    /// The same of several rows, of which a kill leaves all or the beginning of a text.
    pub fn write_rows(&mut self, rows: &[impl AsRef<[Cell]>]) -> Result<()> {
        let mut text = String::new();
        for row in rows.iter().map(AsRef::as_ref) {
            refuse_infinite(&self.path, row)?;
            self.refuse_names(row)?;
            if self.names.is_empty() {
                self.names = row.iter().map(|(name, _)| name.to_string()).collect();
                text += &(self.names.join(",") + "\n");
            }
            text += &(self.laid_out(row).join(",") + "\n");
        }
        self.refuse_change()?;
        self.sums.add(&text)?;
        // one call a step: what a kill leaves is whole lines, or a part that is dropped
        self.file.write_all(text.as_bytes()).map_err(|source| Error::File { path: self.path.clone(), source })?;
        self.length += text.len() as u64;
        Ok(())
    }

    /// Refuses a row that has a name twice or one without a column, and the first row of a run that goes on if it does not have all columns.
    fn refuse_names(&mut self, row: &[Cell]) -> Result<()> {
        let path = self.path.display();
        let twice = (1..row.len()).find(|&place| row[..place].iter().any(|(name, _)| *name == row[place].0));
        if let Some(place) = twice {
            return Err(Error::refused(format!("{path}: a row has two numbers for the column {}; report it", row[place].0)));
        }
        if self.names.is_empty() {
            return Ok(());
        }
        let fresh: Vec<&str> = row.iter().map(|(name, _)| name.as_ref()).filter(|name| !self.names.iter().any(|own| own == name)).collect();
        let gone = |name: &&String| self.inherited && !row.iter().any(|(own, _)| own == *name);
        let gone: Vec<&str> = self.names.iter().filter(gone).map(String::as_str).collect();
        if fresh.is_empty() && gone.is_empty() {
            self.inherited = false;
            return Ok(());
        }
        let words = |what: &str, names: &[&str]| if names.is_empty() { String::new() } else { format!(" {what} {}", names.join(", ")) };
        let differs = format!(
            "{path}: its header{}{}",
            words("lacks the columns", &fresh),
            words("has the columns that this run does not write:", &gone)
        );
        Err(Error::refused(
            differs + "; go on with the version of the program that began it, or remove the file to go on without the rows so far",
        ))
    }

    /// The cells of a row under the names of the columns.
    fn laid_out<'r>(&self, row: &'r [Cell]) -> Vec<&'r str> {
        let under = |(place, column): (usize, &String)| {
            let own = row.get(place).filter(|(name, _)| name == column);
            own.or_else(|| row.iter().find(|(name, _)| name == column)).map_or("", |(_, text)| text)
        };
        self.names.iter().enumerate().map(under).collect()
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::cell::{absent, count, real};
    use super::*;

    fn begin(folder: &Path, step: usize) -> Result<Begun> {
        StepTable::begin(&folder.join("series.csv"), step)
    }

    fn row(step: usize) -> Vec<Cell> {
        vec![count("step", step), real("time", 0.1 * step as f64), absent("smallest_gap"), real("seconds", 0.5)]
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
        assert!(note.is_empty());
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
        let note = begin(&folder, 3).unwrap().lost.remove(0);
        assert!(note.ends_with("series.csv: 3 of the 3 rows before step 3 are missing"), "{note}");
        let mut rows = begin(&folder, 0).unwrap().table;
        (0..2).for_each(|step| rows.write(&row(step)).unwrap());
        let Begun { table: mut rows, lost: note, .. } = begin(&folder, 4).unwrap();
        assert!(note[0].contains("2 of the 4 rows"));
        rows.write(&row(4)).unwrap();
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap().lines().count(), 4);
        fs::write(folder.join("series.csv"), b"step,\xff\n\xff\n").unwrap();
        assert!(matches!(begin(&folder, 3), Err(Error::Refused(_))));
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn cells_stand_under_their_names_and_others_are_refused() {
        let folder = folder("names");
        let mut rows = begin(&folder, 0).unwrap().table;
        rows.write(&[count("step", 0), real("a", 1.0), absent("b")]).unwrap();
        rows.write(&[count("step", 1), real("b", 2.0)]).unwrap();
        let refusal = rows.write(&[count("step", 2), real("a", 1.0), real("b", 2.0), real("c", 3.0)]).unwrap_err().to_string();
        assert!(refusal.contains("series.csv: its header lacks the columns c; "), "{refusal}");
        let refusal = rows.write(&[count("step", 2), real("a", 1.0), real("a", 2.0)]).unwrap_err().to_string();
        assert!(refusal.contains("two numbers for the column a"), "{refusal}");
        assert_eq!(fs::read_to_string(folder.join("series.csv")).unwrap(), "step,a,b\n0,1.0,\n1,,2.0\n");
        // a run that goes on writes the same columns
        let mut rows = begin(&folder, 2).unwrap().table;
        let refusal = rows.write(&[count("step", 2), real("a", 1.0)]).unwrap_err().to_string();
        assert!(refusal.contains("has the columns that this run does not write: b;"), "{refusal}");
        rows.write(&[count("step", 2), real("a", 1.0), real("b", 1.0)]).unwrap();
        rows.write(&[count("step", 3), real("a", 1.0)]).unwrap();
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn rows_that_were_altered_are_refused_with_their_line() {
        let folder = folder("altered");
        let path = folder.join("series.csv");
        let mut rows = begin(&folder, 0).unwrap().table;
        (0..5).for_each(|step| rows.write(&row(step)).unwrap());
        let whole = fs::read_to_string(&path).unwrap();
        for (altered, message) in [
            (whole.replace("0.30000000000000004", "0.3"), ":5: is not the line that the run wrote"),
            (whole.replacen("0.1,,", "0.1,0.0,0.0,", 1), ":3: has 5 cells, and the header has 4 names"),
            (whole.replacen("\n0,", "\n4,", 1), ":3: is no row of a series"),
        ] {
            fs::write(&path, altered).unwrap();
            let refusal = begin(&folder, 5).err().unwrap().to_string();
            assert!(refusal.contains(&format!("series.csv{message}")), "{refusal}");
        }
        // rows that go are not looked at, and a table without checksums is taken as it is
        fs::write(&path, whole.replace("0.30000000000000004", "0.3")).unwrap();
        assert!(begin(&folder, 3).is_ok());
        fs::write(&path, whole.replace("0.30000000000000004", "0.3")).unwrap();
        fs::remove_file(folder.join(".series.csv.sums")).unwrap();
        assert!(begin(&folder, 5).unwrap().lost.is_empty() && begin(&folder, 5).is_ok());
        fs::remove_dir_all(&folder).unwrap();
    }
}
