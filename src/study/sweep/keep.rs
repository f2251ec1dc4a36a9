//! What stays of the runs of a sweep.

use std::{fs, io::ErrorKind, path::Path};

use crate::{
    error::{Error, Result},
    output::{SWEEP_RUNS, prepare_folder},
};

/// What is kept where not all is: it can be opened as a run without frames.
const RESULTS: [&str; 3] = ["summary.json", "series.csv", "scene.toml"];

/// How much of a run is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Keep {
    /// Its summary, its series and its scene.
    Series,
    /// All of its files, also of runs that failed.
    All,
    /// Nothing.
    Nothing,
}

impl Keep {
    /// Keeps what is to be kept of a run in the folder of a sweep; gives the path from there.
    ///
    /// # Errors
    /// A file cannot be moved.
    pub fn keep(self, run: &Path, sweep: &Path, name: &str) -> Result<Option<String>> {
        let (path, to) = (format!("{SWEEP_RUNS}/{name}"), sweep.join(SWEEP_RUNS).join(name));
        remove(&to)?;
        match self {
            Keep::Nothing => return Ok(None),
            Keep::All => {
                prepare_folder(&sweep.join(SWEEP_RUNS))?;
                rename(run, &to)?;
            }
            Keep::Series => {
                prepare_folder(&to)?;
                let mut there = RESULTS.into_iter().filter(|file| run.join(file).exists());
                there.try_for_each(|file| rename(&run.join(file), &to.join(file)))?;
            }
        }
        Ok(Some(path))
    }

    /// Keeps what a failed run has left, or else clears it away for the next one.
    ///
    /// # Errors
    /// A file cannot be moved.
    pub fn keep_failed(self, run: &Path, sweep: &Path, name: &str) -> Result<()> {
        match self {
            Keep::All if run.exists() => self.keep(run, sweep, name).map(|_| ()),
            _ => remove(run),
        }
    }
}

fn rename(from: &Path, to: &Path) -> Result<()> {
    fs::rename(from, to).map_err(|source| Error::File { path: to.to_owned(), source })
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_dir_all(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(Error::File { path: path.to_owned(), source }),
        _ => Ok(()),
    }
}
