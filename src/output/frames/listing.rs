//! A file that lists frames and grows with them, of which readers never meet half: two versions of it take turns.
//!
//! The version under the file's name is whole and is not touched. The other one, beside it under another name, is a few frames behind: these
//! are added to it, and the two exchange their names. So a frame costs what its own entry takes, however many there were before. A version
//! that somebody still reads, or that is not as it was left, is written anew from all entries instead.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use rustix::fs::{CWD, RenameFlags, renameat_with};

use super::entry::Entry;
use crate::{
    error::{Error, Result},
    output::files::file::{remove_file, temporary},
};

/// What a list of frames looks like in a file. A file that cannot be written whole is an error.
pub(super) trait Format {
    /// Whether a file without entries is written; readers of some formats take an empty list for a broken one.
    fn empty(&self) -> bool;

    /// Whether a frame is listed.
    fn lists(&self, entry: &Entry) -> bool;

    /// Writes a new file with these entries.
    fn create(&self, path: &Path, entries: &[&Entry]) -> io::Result<()>;

    /// Adds entries to a file; one of a format that cannot is written anew.
    fn append(&self, _path: &Path, _entries: &[&Entry]) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// A list of frames in a format. What it leaves beside the file goes when it is dropped.
pub(super) struct Listing<F: Format> {
    path: PathBuf,
    format: F,
    /// The version under the file's name, and the one beside it.
    seen: Option<Version>,
    behind: Option<Version>,
}

/// A version as it was left.
struct Version {
    /// Frames of the run that it knows of.
    frames: usize,
    /// Bytes.
    length: u64,
}

impl<F: Format> Listing<F> {
    /// A list of which nothing is written yet.
    ///
    /// # Errors
    /// [`Error::File`], here and below.
    pub fn new(path: PathBuf, format: F) -> Result<Listing<F>> {
        remove_file(&temporary(&path))?;
        Ok(Listing { path, format, seen: None, behind: None })
    }

    /// Writes the file anew.
    pub fn rewrite(&mut self, entries: &[Entry]) -> Result<()> {
        self.settle()?;
        self.seen = None;
        if !self.format.empty() && !entries.iter().any(|entry| self.format.lists(entry)) {
            return remove_file(&self.path);
        }
        self.update(entries)
    }

    /// Leaves nothing beside the file.
    pub fn settle(&mut self) -> Result<()> {
        self.behind = None;
        remove_file(&temporary(&self.path))
    }

    /// Lists what is new since the last time; `entries` are those of then with some more.
    pub fn update(&mut self, entries: &[Entry]) -> Result<()> {
        let known = self.seen.as_ref().map_or(0, |version| version.frames);
        let first = self.seen.is_none() && self.format.empty();
        if !first && !entries[known..].iter().any(|entry| self.format.lists(entry)) {
            return Ok(());
        }
        self.bring_up_to_date(entries).map_err(|source| {
            // the error that matters is the first one
            let _ = fs::remove_file(temporary(&self.path));
            Error::File { path: self.path.clone(), source }
        })
    }

    fn bring_up_to_date(&mut self, entries: &[Entry]) -> io::Result<()> {
        let beside = temporary(&self.path);
        let appended = self.behind.take().filter(|behind| length(&beside).is_ok_and(|length| length == behind.length));
        let appended = appended.is_some_and(|behind| self.format.append(&beside, &self.listed(&entries[behind.frames..])).is_ok());
        if !appended {
            remove_if_there(&beside)?;
            self.format.create(&beside, &self.listed(entries))?;
        }
        fs::File::open(&beside)?.sync_all()?;
        let version = Version { frames: entries.len(), length: length(&beside)? };
        let seen = self.seen.replace(version);
        // not every file system can exchange two files
        match seen.filter(|_| renameat_with(CWD, &beside, CWD, &self.path, RenameFlags::EXCHANGE).is_ok()) {
            Some(seen) => self.behind = Some(seen),
            None => fs::rename(&beside, &self.path)?,
        }
        Ok(())
    }

    fn listed<'e>(&self, entries: &'e [Entry]) -> Vec<&'e Entry> {
        entries.iter().filter(|entry| self.format.lists(entry)).collect()
    }
}

impl<F: Format> Drop for Listing<F> {
    fn drop(&mut self) {
        let _ = fs::remove_file(temporary(&self.path));
    }
}

fn length(path: &Path) -> io::Result<u64> {
    fs::metadata(path).map(|metadata| metadata.len())
}

fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
