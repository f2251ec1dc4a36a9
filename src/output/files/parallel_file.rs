//! HDF5 files that all ranks write together through MPI-IO, under another name, and that take their name once they are whole on disk.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use super::file::temporary;
use crate::{
    error::{Error, Result},
    parallel::World,
};

/// Room for what describes the file, and for what describes a data set, in bytes; both need less than half of it.
const DESCRIPTION: u64 = 1 << 16;
const DESCRIPTION_OF_DATA_SET: u64 = 1 << 12;

/// A file under way. Dropped before [`finish`](ParallelFile::finish), it leaves nothing behind.
pub struct ParallelFile<'a> {
    world: &'a World,
    path: PathBuf,
    temporary: PathBuf,
    file: Option<hdf5::File>,
    /// Bytes that the disk has promised.
    room: u64,
}

impl<'a> ParallelFile<'a> {
    /// Opens the file under another name.
    pub fn create(world: &'a World, path: &Path) -> Result<ParallelFile<'a>> {
        let mut file = ParallelFile { world, path: path.to_owned(), temporary: temporary(path), file: None, room: 0 };
        // the system says better than HDF5 why a file cannot be made
        file.on_first_rank(|temporary| fs::File::create(temporary).and_then(|file| reserve(&file, 0, DESCRIPTION)))?;
        let communicator = world.raw();
        // the newer file format has checksums in its metadata
        let options = hdf5::File::with_options().with_fapl(|access| access.mpio(communicator, None).libver_v110()).clone();
        let opened = options.create(&file.temporary).map_err(|error| file.error(cause(&error)));
        file.file = Some(world.agree(opened)?);
        // opening has given the room back
        file.extend(DESCRIPTION)?;
        Ok(file)
    }

    /// Makes room for a data set of so many bytes before it is made: on a full disk HDF5 would wait for ever for the rank that
    /// cannot write its part of the description.
    pub fn make_room(&mut self, bytes: usize) -> Result<()> {
        self.extend(bytes as u64 + DESCRIPTION_OF_DATA_SET)
    }

    fn extend(&mut self, bytes: u64) -> Result<()> {
        let start = self.room;
        self.room += bytes;
        self.on_first_rank(|temporary| fs::File::options().write(true).open(temporary).and_then(|file| reserve(&file, start, bytes)))
    }

    /// The ranks that write.
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// Takes a step on every rank. Making groups, data sets and attributes is collective; a write may fail on one rank alone,
    /// so that nothing collective may follow it in the same step.
    pub fn step<T>(&self, step: impl FnOnce(&hdf5::Group) -> hdf5::Result<T>) -> Result<T> {
        let file = self.file.as_ref().expect("open until finished");
        self.world.agree(step(file).map_err(|error| self.error(cause(&error))))
    }

    /// Closes the file, waits until it is on disk and gives it its name.
    pub fn finish(mut self) -> Result<()> {
        let file = self.file.take().expect("open until finished");
        self.world.agree(file.close().map_err(|error| self.error(cause(&error))))?;
        // each rank for its own machine's share
        self.world.agree(fs::File::open(&self.temporary).and_then(|file| file.sync_all()).map_err(|source| self.error(source)))?;
        self.on_first_rank(|temporary| {
            fs::rename(temporary, &self.path)?;
            self.path.parent().map_or(Ok(()), |folder| fs::File::open(folder)?.sync_all())
        })
    }

    fn on_first_rank(&self, act: impl FnOnce(&Path) -> io::Result<()>) -> Result<()> {
        self.world.on_first_rank(|| act(&self.temporary).map_err(|source| self.error(source)))
    }

    fn error(&self, source: io::Error) -> Error {
        Error::File { path: self.path.clone(), source }
    }
}

impl Drop for ParallelFile<'_> {
    fn drop(&mut self) {
        self.file = None;
        if self.world.rank() == 0 {
            // it is there only if something failed before
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Room on the disk; without complaint where the file system cannot promise any.
pub fn reserve(file: &fs::File, start: u64, bytes: u64) -> io::Result<()> {
    match rustix::fs::fallocate(file, rustix::fs::FallocateFlags::empty(), start, bytes) {
        Err(error @ (rustix::io::Errno::NOSPC | rustix::io::Errno::DQUOT | rustix::io::Errno::FBIG)) => Err(error.into()),
        _ => Ok(()),
    }
}

/// An error of HDF5 with what lay at its bottom, where it tells of a full disk.
pub fn cause(error: &hdf5::Error) -> io::Error {
    let bottom = error.stack().and_then(|stack| stack.last().map(|frame| frame.desc().to_owned()));
    io::Error::other(bottom.map_or_else(|| error.to_string(), |bottom| format!("{error}: {bottom}")))
}
