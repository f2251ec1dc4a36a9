//! Checksums of the lines of a table, in a file of their own beside it: readers of the table never meet them.
//!
//! The hidden file `.series.csv.sums` has a line of 16 hexadecimal digits for each line of `series.csv`, the header first. The sum of a line goes to the
//! disk before the line, so that the end of the program at any moment leaves no line without its sum; sums beyond the last line mean nothing.

use std::{
    fs::{self, File, OpenOptions},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use crate::{
    error::{Error, Result},
    output::{checksum_of, write_whole},
};

/// The sums of a table, open for those of further lines.
pub struct Checksums {
    path: PathBuf,
    file: File,
}

impl Checksums {
    /// Those of these lines of a table, and of lines to come.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(table: &Path, kept: &str) -> Result<Checksums> {
        let path = beside(table);
        write_whole(&path, sums_of(kept).as_bytes())?;
        let file = OpenOptions::new().append(true).open(&path).map_err(|source| Error::File { path: path.clone(), source })?;
        Ok(Checksums { path, file })
    }

    /// Adds the sums of whole lines.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, lines: &str) -> Result<()> {
        self.file.write_all(sums_of(lines).as_bytes()).map_err(|source| Error::File { path: self.path.clone(), source })
    }
}

/// Refuses the first of the first lines of a table that is not as it was written; says how many have no sum where others have.
///
/// # Errors
/// [`Error::Refused`] with the file and the line; [`Error::File`] when the sums cannot be read.
pub fn verify(table: &Path, kept: &str) -> Result<Option<String>> {
    let path = beside(table);
    let sums = match fs::read(&path) {
        // the table of an earlier version
        Err(source) if source.kind() == ErrorKind::NotFound => return Ok(None),
        sums => sums.map_err(|source| Error::File { path: path.clone(), source })?,
    };
    let sums = String::from_utf8_lossy(&sums);
    let whole = sums.split_inclusive('\n').filter_map(|sum| sum.strip_suffix('\n'));
    let mut checked = 0;
    for (line, sum) in kept.lines().zip(whole) {
        checked += 1;
        if sum_of(line) != sum {
            let (table, sums) = (table.display(), path.display());
            return Err(Error::refused(format!(
                "{table}:{checked}: is not the line that the run wrote (its checksum in {sums} differs); put the file back, or remove it to go on \
                 without the rows so far, or remove {sums} to go on with the rows as they are"
            )));
        }
    }
    let lines = kept.lines().count();
    let unknown = || {
        format!("{}: lacks the checksums of the last {} lines of the table, which are taken as they are", path.display(), lines - checked)
    };
    Ok((checked < lines).then(unknown))
}

/// Where the sums of a table are.
fn beside(table: &Path) -> PathBuf {
    table.with_file_name(format!(".{}.sums", table.file_name().unwrap_or_default().to_string_lossy()))
}

fn sum_of(line: &str) -> String {
    format!("{:016x}", checksum_of(line))
}

fn sums_of(lines: &str) -> String {
    lines.lines().map(|line| sum_of(line) + "\n").collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_differs_is_named_and_lines_without_sums_are_told_of() {
        let folder = std::env::temp_dir().join(format!("turbid-sums-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let table = folder.join("series.csv");
        let kept = "step,time\n0,0.0\n1,0.5\n";
        assert_eq!(verify(&table, kept).unwrap(), None, "a table of an earlier version is read");
        let mut sums = Checksums::begin(&table, "step,time\n").unwrap();
        let warning = verify(&table, kept).unwrap().unwrap();
        assert!(warning.contains(".series.csv.sums: lacks the checksums of the last 2 lines"), "{warning}");
        sums.add("0,0.0\n1,0.5\n2,1.0\n").unwrap();
        assert_eq!(verify(&table, kept).unwrap(), None);
        for (altered, line) in [("step,time\n0,0.0\n1,0.6\n", 3), ("step,time\n1,0.5\n0,0.0\n", 2), ("step,Time\n0,0.0\n", 1)] {
            let refusal = verify(&table, altered).unwrap_err().to_string();
            assert!(refusal.contains(&format!("series.csv:{line}: is not the line that the run wrote")), "{refusal}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
