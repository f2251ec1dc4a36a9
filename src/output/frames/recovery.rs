//! What a run that goes on, or begins anew, finds of its frames.
//!
//! A frame that is missing leaves a gap in the numbers, one that cannot be read is set aside under another name: the run goes on
//! without them, and all others stay listed.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use super::{
    entry::{Entry, FOLDER, path_in_run},
    index::{self, Index},
    read,
};
use crate::error::{Error, Result};

/// The frames that stay.
#[derive(Default)]
pub(super) struct KeptFrames {
    /// In the order of time.
    pub entries: Vec<Entry>,
    /// Which lists them.
    pub index: Option<Index>,
    /// Number of the next frame; that of a lost one is not given again.
    pub next: usize,
    /// What is missing, a sentence each.
    pub notes: Vec<String>,
}

/// Most frames that a message names.
const MOST_NAMED: usize = 8;

/// A frame that is there.
enum Found {
    Kept(Entry),
    Later,
    Damaged(String),
}

/// Removes the frames after `time`, last first, and lists the others anew, in VTKHDF too if it is wanted.
pub(super) fn keep_until(folder: &Path, time: f64, vtkhdf: bool) -> Result<KeptFrames> {
    let frames = folder.join(FOLDER);
    fs::create_dir_all(&frames).map_err(|source| Error::File { path: frames, source })?;
    index::remove_halves(folder)?;
    let (listed, note) = if time == f64::NEG_INFINITY { (Vec::new(), None) } else { listed(folder) };
    let mut kept = KeptFrames { notes: note.into_iter().collect(), ..KeptFrames::default() };
    let mut there = BTreeSet::new();
    for (number, path) in index::frame_files(folder)?.into_iter().rev() {
        match find(number, &path, time, &listed) {
            Found::Kept(entry) => kept.entries.push(entry),
            Found::Later => {
                fs::remove_file(&path).map_err(|source| Error::File { path, source })?;
                continue;
            }
            Found::Damaged(reason) => kept.notes.push(set_aside(&path, &reason)?),
        }
        there.insert(number);
    }
    kept.entries.reverse();
    let expected = listed.iter().filter(|(_, listed)| *listed <= time).map(|(number, _)| *number);
    kept.next = expected.chain(there.iter().copied()).max().map_or(0, |last| last + 1);
    kept.notes.extend(missing(folder, (0..kept.next).filter(|number| !there.contains(number))));
    kept.index = Some(Index::begin(folder, &kept.entries, vtkhdf)?);
    Ok(kept)
}

/// Takes frames that are no longer there off the list, and says which.
pub(super) fn forget_lost(folder: &Path, entries: &mut Vec<Entry>, index: &mut Index) -> Result<Option<String>> {
    let there = |number: usize| folder.join(path_in_run(number)).exists();
    let lost: Vec<usize> = entries.iter().map(|entry| entry.number).filter(|&number| !there(number)).collect();
    if !lost.is_empty() {
        entries.retain(|entry| !lost.contains(&entry.number));
        index.rewrite(entries)?;
    }
    index.settle(entries)?;
    Ok(missing(folder, lost.into_iter()))
}

/// What the index of the run so far says, and what is wrong with it.
fn listed(folder: &Path) -> (Vec<(usize, f64)>, Option<String>) {
    match index::listed(folder) {
        Ok(listed) => (listed, None),
        Err(reason) => (Vec::new(), Some(format!("{reason}: it is written anew from the frames"))),
    }
}

fn find(number: usize, path: &Path, time: f64, listed: &[(usize, f64)]) -> Found {
    if time == f64::NEG_INFINITY {
        return Found::Later;
    }
    match read::entry(number, path) {
        Ok(entry) if entry.time <= time => read::verify(path).map_or_else(Found::Damaged, |()| Found::Kept(entry)),
        Ok(_) => Found::Later,
        Err(_) if listed.iter().any(|&(other, later)| other == number && later > time) => Found::Later,
        Err(reason) => Found::Damaged(reason),
    }
}

/// Gives a frame that cannot be read a name that readers of frames do not look for.
fn set_aside(path: &Path, reason: &str) -> Result<String> {
    let aside = PathBuf::from(format!("{}.damaged", path.display()));
    fs::rename(path, &aside).map_err(|source| Error::File { path: path.to_owned(), source })?;
    Ok(format!("{reason}; it is set aside as {} and no longer listed", aside.display()))
}

/// A sentence about frames that are missing, if any are.
fn missing(folder: &Path, numbers: impl Iterator<Item = usize>) -> Option<String> {
    let names: Vec<String> = numbers.map(|number| format!("{number:06}.h5")).collect();
    let (shown, more) = (&names[..names.len().min(MOST_NAMED)], names.len().saturating_sub(MOST_NAMED));
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let place = folder.join(FOLDER);
    (!names.is_empty()).then(|| format!("{}: {}{more} missing; the others stay listed", place.display(), shown.join(", ")))
}
