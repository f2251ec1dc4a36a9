//! An experiment: settings of scenes, a run of its own for each, and a record of what came of it.
//!
//! Every run is a program of its own, started by a launcher on any number of ranks, so that its memory and its failure are its own. All records are kept in one
//! file after every run; an experiment that is started again measures only what is missing. What is concluded from the records is up to the studies.

pub mod arguments;
pub mod folder;
pub mod launcher;
pub mod record;
pub mod store;
pub mod summary;
pub mod table;

use std::{fmt, path::PathBuf};

use serde::Serialize;

use self::{
    arguments::Start,
    folder::StudyFolder,
    launcher::Launcher,
    store::{Recorded, Store, StudyIdentity},
};
use crate::{error::Result, output::note};

/// What runs, where it leaves its output, and what is known so far.
pub struct Experiment<R> {
    /// What starts runs.
    pub launcher: Launcher,
    /// The folder of the results.
    pub folder: StudyFolder,
    /// What was measured.
    pub store: Store<R>,
}

impl<R: Recorded> Experiment<R> {
    /// Takes a folder and reads the records in a file of it; none if the experiment starts `fresh`.
    ///
    /// # Errors
    /// The launcher cannot be used, or the folder holds another experiment or is held by another program.
    pub fn open(start: &Start, folder: PathBuf, file: &'static str, identity: StudyIdentity, fresh: bool) -> Result<Experiment<R>> {
        let launcher = Launcher::new(start)?;
        let folder = StudyFolder::take(folder)?;
        let store = Store::open(&folder.path, file, identity, fresh)?;
        Ok(Experiment { launcher, folder, store })
    }

    /// Measures the settings of which there is no record, and tells of each.
    ///
    /// # Errors
    /// A run cannot be started, or its record cannot be written.
    pub fn complete(&mut self, settings: &[R::Setting], measure: impl Fn(&Experiment<R>, &R::Setting) -> Result<R>) -> Result<()>
    where
        R: fmt::Display,
    {
        let missing: Vec<&R::Setting> = settings.iter().filter(|setting| self.store.find(setting).is_none()).collect();
        if missing.len() < settings.len() {
            note(&format!("{} of {} runs were measured before", settings.len() - missing.len(), settings.len()));
        }
        for (number, setting) in (1..).zip(&missing) {
            let record = measure(self, setting)?;
            note(&format!("{number} of {}: {record}", missing.len()));
            self.store.add(record)?;
        }
        Ok(())
    }

    /// Writes the records with what was found, and files by name and contents; gives a line with the names of all of them.
    ///
    /// # Errors
    /// One cannot be written.
    pub fn write(&self, findings: Option<&impl Serialize>, files: &[(impl AsRef<str>, String)]) -> Result<String> {
        self.store.write(findings)?;
        let names: String = files.iter().map(|(name, _)| format!(", {}", name.as_ref())).collect();
        self.folder.write(files)?;
        Ok(format!("files: {}: {}{names}", self.folder.path.display(), self.store.file()))
    }
}
