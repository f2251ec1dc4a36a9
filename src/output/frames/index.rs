//! What is known of all frames: `run.h5` with links to them, and the companions for ParaView.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    entry::{Entry, FOLDER, path_in_run},
    xdmf,
};
use crate::{
    error::{Error, Result},
    output::{
        file::{remove_file, temporary, write_whole},
        parallel_file::{cause, reserve},
    },
};

const RUN: &str = "run.h5";
const BODIES: &str = "bodies.xdmf";
const FIELDS: &str = "fields.xdmf";
const CONTACTS: &str = "contacts.xdmf";

/// Room that `run.h5` takes, and each frame in it, in bytes; both need less than half of it.
const ROOM: u64 = 1 << 14;
const ROOM_OF_ENTRY: u64 = 1 << 9;

/// Writes `run.h5` and the companions; one that would list nothing is not there, since readers take an empty one for a broken one.
pub(super) fn write(folder: &Path, entries: &[Entry]) -> Result<()> {
    write_run(&folder.join(RUN), entries)?;
    let companions = [(BODIES, xdmf::bodies(entries)), (CONTACTS, xdmf::contacts(entries)), (FIELDS, xdmf::fields(entries))];
    companions.into_iter().try_for_each(|(name, text)| match text {
        Some(text) => write_whole(&folder.join(name), text.as_bytes()),
        None => remove_file(&folder.join(name)),
    })
}

/// Numbers and times of the frames that `run.h5` lists, or what is wrong with it.
pub(super) fn listed(folder: &Path) -> std::result::Result<Vec<(usize, f64)>, String> {
    let path = folder.join(RUN);
    if !path.exists() {
        return Err(format!("{} is missing", path.display()));
    }
    let read = || {
        let file = hdf5::File::open(&path)?;
        let mut numbers: Vec<usize> = file.group(FOLDER)?.member_names()?.iter().filter_map(|name| name.parse().ok()).collect();
        numbers.sort_unstable();
        let times = file.dataset("times")?.read_raw::<f64>()?;
        Ok::<_, hdf5::Error>(numbers.into_iter().zip(times).collect())
    };
    read().map_err(|error| format!("{} cannot be read ({error})", path.display()))
}

/// The frames in the folder of a run, in their order.
pub(super) fn frame_files(folder: &Path) -> Result<Vec<(usize, PathBuf)>> {
    let number = |path: &Path| path.extension().filter(|ending| *ending == "h5").and(path.file_stem()?.to_str()?.parse::<usize>().ok());
    let mut frames: Vec<_> = files(&folder.join(FOLDER))?.into_iter().filter_map(|path| Some((number(&path)?, path))).collect();
    frames.sort();
    Ok(frames)
}

/// Removes frames that were under way when a run ended.
pub(super) fn remove_halves(folder: &Path) -> Result<()> {
    let halves = files(&folder.join(FOLDER))?.into_iter().filter(|path| path.to_string_lossy().ends_with(".h5.part"));
    halves.into_iter().try_for_each(|path| fs::remove_file(&path).map_err(|source| Error::File { path, source }))
}

fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>();
    list().map_err(|source| Error::File { path: folder.to_owned(), source })
}

fn write_run(path: &Path, entries: &[Entry]) -> Result<()> {
    let temporary = temporary(path);
    // a file that HDF5 cannot close on a full disk brings the program down at its end
    let room = ROOM + ROOM_OF_ENTRY * entries.len() as u64;
    let written = fs::File::create(&temporary).and_then(|file| reserve(&file, 0, room));
    let written = written.and_then(|()| link_frames(&temporary, entries).map_err(|error| cause(&error)));
    let renamed = written.and_then(|()| fs::File::open(&temporary)?.sync_all()).and_then(|()| fs::rename(&temporary, path));
    renamed.map_err(|source| {
        // the error that matters is the first one
        let _ = fs::remove_file(&temporary);
        Error::File { path: path.to_owned(), source }
    })
}

fn link_frames(path: &Path, entries: &[Entry]) -> hdf5::Result<()> {
    let file = hdf5::File::create(path)?;
    let frames = file.create_group(FOLDER)?;
    for entry in entries {
        frames.link_external(&path_in_run(entry.number), "/", &format!("{:06}", entry.number))?;
    }
    let times = file.new_dataset::<f64>().shape(entries.len()).create("times")?;
    let steps = file.new_dataset::<u64>().shape(entries.len()).create("steps")?;
    if !entries.is_empty() {
        times.write_raw(&entries.iter().map(|entry| entry.time).collect::<Vec<_>>())?;
        steps.write_raw(&entries.iter().map(|entry| entry.step as u64).collect::<Vec<_>>())?;
    }
    drop((frames, times, steps));
    file.close()
}
