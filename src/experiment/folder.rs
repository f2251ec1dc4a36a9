//! The folder of a study, and room for its runs within it.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::{
    error::Result,
    output::{FolderLock, prepare_folder, write_whole},
};

/// How names of folders for runs begin.
const RUNS: &str = "runs-";

/// A folder for runs, which is removed in the end.
pub struct Scratch(pub PathBuf);

impl Scratch {
    /// A new folder within `folder`, where all ranks of a cluster can read it.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn within(folder: &Path) -> Result<Scratch> {
        let scratch = Scratch(folder.join(format!("{RUNS}{}", std::process::id())));
        prepare_folder(&scratch.0)?;
        Ok(scratch)
    }
}

/// The folder of a study's results, which no other study may use meanwhile, with one for its runs within it.
pub struct StudyFolder {
    /// Where it is.
    pub path: PathBuf,
    /// Where runs leave their output.
    pub scratch: Scratch,
    _lock: FolderLock,
}

impl StudyFolder {
    /// Takes a folder, without what studies that were killed have left in it.
    ///
    /// # Errors
    /// It cannot be written to, or another study holds it.
    pub fn take(path: PathBuf) -> Result<StudyFolder> {
        prepare_folder(&path)?;
        let lock = FolderLock::take(&path)?;
        sweep_out(&path);
        Ok(StudyFolder { scratch: Scratch::within(&path)?, path, _lock: lock })
    }

    /// Writes files by name and contents.
    ///
    /// # Errors
    /// One cannot be written.
    pub fn write(&self, files: &[(impl AsRef<str>, String)]) -> Result<()> {
        files.iter().try_for_each(|(name, text)| write_whole(&self.path.join(name.as_ref()), text.as_bytes()))
    }
}

/// Removes what studies that were killed have left within a folder; a run of theirs that is still under way fails.
pub fn sweep_out(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let stale = entries.filter(|path| path.is_dir() && path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(RUNS)));
    for path in stale {
        // what cannot be removed now is only in the way
        let _ = fs::remove_dir_all(path);
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // what cannot be removed now is only in the way
        let _ = fs::remove_dir_all(&self.0);
    }
}
