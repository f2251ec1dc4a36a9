//! `run.h5`: all frames as one file.

use std::{fs, io, path::Path};

use super::{
    entry::{Entry, FOLDER, path_in_run},
    listing::Format,
};
use crate::output::files::parallel_file::{cause, reserve};

/// Name of the file.
pub(super) const RUN: &str = "run.h5";

/// Room that a new `run.h5` takes, and each frame in it, in bytes; both need less than half of it.
const ROOM: u64 = 1 << 14;
const ROOM_OF_ENTRY: u64 = 1 << 9;

/// Most that the names of further frames make `run.h5` grow by at once, in bytes: a block of HDF5's heap.
pub(super) const LARGEST_BLOCK: u64 = 1 << 16;

/// Times and steps that are stored together, as readers find them.
const CHUNK: usize = 512;

/// A link to each frame, and their times and steps.
pub(super) struct RunFile;

impl Format for RunFile {
    fn empty(&self) -> bool {
        true
    }

    fn lists(&self, _: &Entry) -> bool {
        true
    }

    fn create(&self, path: &Path, entries: &[&Entry]) -> io::Result<()> {
        // a file that HDF5 cannot close on a full disk brings the program down at its end
        reserve(&fs::File::create(path)?, 0, ROOM + ROOM_OF_ENTRY * entries.len() as u64)?;
        create_run(path, entries).map_err(|error| cause(&error))
    }

    fn append(&self, path: &Path, entries: &[&Entry]) -> io::Result<()> {
        let file = fs::File::options().write(true).open(path)?;
        let length = file.metadata()?.len();
        reserve(&file, length, ROOM + ROOM_OF_ENTRY * entries.len() as u64 + length.min(LARGEST_BLOCK))?;
        append_to_run(path, entries).map_err(|error| cause(&error))
    }
}

fn create_run(path: &Path, entries: &[&Entry]) -> hdf5::Result<()> {
    // the newer file format has checksums in its metadata, and lists that grow without being copied
    let file = hdf5::File::with_options().with_fapl(|access| access.libver_v110()).create(path)?;
    file.create_group(FOLDER)?;
    file.new_dataset::<f64>().chunk(CHUNK).shape(0..).create("times")?;
    file.new_dataset::<u64>().chunk(CHUNK).shape(0..).create("steps")?;
    list(&file, entries)?;
    file.close()
}

fn append_to_run(path: &Path, entries: &[&Entry]) -> hdf5::Result<()> {
    let file = hdf5::File::with_options().with_fapl(|access| access.libver_v110()).open_rw(path)?;
    list(&file, entries)?;
    file.close()
}

fn list(file: &hdf5::File, entries: &[&Entry]) -> hdf5::Result<()> {
    let frames = file.group(FOLDER)?;
    for entry in entries {
        frames.link_external(&path_in_run(entry.number), "/", &format!("{:06}", entry.number))?;
    }
    add(&file.dataset("times")?, entries.iter().map(|entry| entry.time).collect())?;
    add(&file.dataset("steps")?, entries.iter().map(|entry| entry.step as u64).collect())
}

/// Makes a list longer.
fn add<T: hdf5::H5Type>(list: &hdf5::Dataset, values: Vec<T>) -> hdf5::Result<()> {
    let (start, count) = (list.size(), values.len());
    if count == 0 {
        return Ok(());
    }
    list.resize(start + count)?;
    list.write_slice(&values, start..start + count)
}
