//! Checkpoints: named texts, numbers and lattices in one HDF5 file that is complete or absent.
//!
//! All functions are collective. Every entry carries a checksum that does not depend on the number of ranks, and a lattice is
//! stored in its natural order, so that any number of ranks reads what another number wrote. What the names mean is not known here.

use std::path::{Path, PathBuf};

use super::{
    checksum::{checksum, checksum_of, numbers_checksum, sum_of_all},
    parallel_file::ParallelFile,
    rows::Rows,
    slab,
};
use crate::{
    error::{Error, Offer, Refusal, Result},
    grid::Grid,
    parallel::World,
};

const FORMAT: &str = "turbid checkpoint";
const VERSION: u32 = 1;

/// A checkpoint under way. Dropped before [`finish`](CheckpointWriter::finish), it leaves nothing behind.
pub struct CheckpointWriter<'a> {
    file: ParallelFile<'a>,
}

impl<'a> CheckpointWriter<'a> {
    /// Begins a checkpoint beside `path`.
    ///
    /// # Errors
    /// [`Error::File`], here and below, when the file cannot be written.
    pub fn create(world: &'a World, path: &Path) -> Result<CheckpointWriter<'a>> {
        let file = ParallelFile::create(world, path)?;
        file.step(|root| {
            slab::set_text(root, "format", FORMAT)?;
            slab::set(root, "version", VERSION)
        })?;
        Ok(CheckpointWriter { file })
    }

    /// Stores a text that is the same on all ranks.
    pub fn text(&mut self, name: &str, text: &str) -> Result<()> {
        self.alike(name, text.as_bytes(), checksum_of(text))
    }

    /// Stores numbers that are the same on all ranks.
    pub fn shared(&mut self, name: &str, values: &[f64]) -> Result<()> {
        self.alike(name, values, numbers_checksum(0, values))
    }

    /// Stores rows of `width` numbers that belong to so many bodies, one after the other in the order of the bodies. A rank gives the rows of some
    /// of them in that order, each with the number of its body before it; all rows of a body are on one rank.
    pub fn rows(&mut self, name: &str, bodies: usize, width: usize, rows: Vec<f64>) -> Result<()> {
        let world = self.file.world();
        let rows = Rows::in_order(world, bodies, width + 1, rows);
        let values = rows.columns(1..width + 1, |value| value);
        let start = rows.places().start * width;
        let sum = sum_of_all(world, numbers_checksum(start, &values));
        self.file.make_room(rows.total() * width * size_of::<f64>())?;
        let dataset = self.file.step(|root| {
            let dataset = root.new_dataset::<f64>().shape(rows.total() * width).create(name)?;
            slab::set(&dataset, "checksum", sum)?;
            Ok(dataset)
        })?;
        let range = start..start + values.len();
        self.file.step(|_| if range.is_empty() { Ok(()) } else { slab::write(&dataset, &[range], &values) })
    }

    /// Stores a field, of which each rank gives the values in its block.
    pub fn lattice<const D: usize>(&mut self, name: &str, grid: &Grid<D>, field: usize, values: &[f64]) -> Result<()> {
        let whole = grid.lattice(field);
        let ranges = slab::ranges(grid.block(field), whole);
        let sum = lattice_checksum(self.file.world(), grid, field, values);
        let shape: Vec<usize> = slab::ranges(whole, whole).iter().map(|range| range.end).collect();
        self.file.make_room(whole.len() * size_of::<f64>())?;
        let dataset = self.file.step(|root| {
            let dataset = root.new_dataset::<f64>().shape(shape).create(name)?;
            slab::set(&dataset, "checksum", sum)?;
            Ok(dataset)
        })?;
        self.file.step(|_| slab::write(&dataset, &ranges, values))
    }

    /// Gives the checkpoint its name, once it is whole on disk.
    pub fn finish(self) -> Result<()> {
        self.file.finish()
    }

    fn alike<T: hdf5::H5Type>(&mut self, name: &str, values: &[T], sum: u64) -> Result<()> {
        self.file.make_room(size_of_val(values))?;
        let dataset = self.file.step(|root| {
            let dataset = root.new_dataset::<T>().shape(values.len()).create(name)?;
            slab::set(&dataset, "checksum", sum)?;
            Ok(dataset)
        })?;
        let written = self.file.world().rank() == 0 && !values.is_empty();
        self.file.step(|_| if written { dataset.write_raw(values) } else { Ok(()) })
    }
}

/// A checkpoint to read. What cannot be used is [`Error::Refused`] with the file, what is wrong and the remedy, on all ranks.
pub struct Checkpoint<'a> {
    world: &'a World,
    path: PathBuf,
    file: hdf5::File,
}

impl<'a> Checkpoint<'a> {
    /// Opens a checkpoint.
    ///
    /// # Errors
    /// [`Error::Refused`] for a missing, truncated, corrupt or foreign file.
    pub fn open(world: &'a World, path: &Path) -> Result<Checkpoint<'a>> {
        let file = world.agree(open(path).map_err(|what| refused(path, &what)))?;
        Ok(Checkpoint { world, path: path.to_owned(), file })
    }

    /// The text of this name.
    ///
    /// # Errors
    /// [`Error::Refused`], here and below, when there is none or it is corrupt.
    pub fn text(&self, name: &str) -> Result<String> {
        let bytes = self.alike::<u8>(name, |&byte| u64::from(byte))?;
        self.world.agree(String::from_utf8(bytes).map_err(|_| self.corrupt(name)))
    }

    /// The text of this name; nothing where there is none, as in checkpoints of older versions.
    pub fn text_if_any(&self, name: &str) -> Result<Option<String>> {
        if self.file.link_exists(name) { self.text(name).map(Some) } else { Ok(None) }
    }

    /// The numbers of this name.
    pub fn shared(&self, name: &str) -> Result<Vec<f64>> {
        self.alike::<f64>(name, |value| value.to_bits())
    }

    /// This rank's [share](World::share) of the rows of this name, one for each of so many bodies; nothing where there are not so many.
    pub fn rows(&self, name: &str, bodies: usize, width: usize) -> Result<Option<Vec<f64>>> {
        let dataset = self.world.agree(self.dataset(name))?;
        if dataset.shape() != [bodies * width] {
            return Ok(None);
        }
        let range = self.world.share(bodies);
        let range = range.start * width..range.end * width;
        let read = || {
            // an empty selection cannot be read, and the size is believed only if the file is large enough for it
            let values = match range.is_empty() {
                true => Vec::new(),
                false if dataset.size().saturating_mul(size_of::<f64>()) as u64 > self.file.size() => return Err(self.corrupt(name)),
                false => slab::read(&dataset, std::slice::from_ref(&range)).map_err(|_| self.corrupt(name))?,
            };
            Ok((values, self.stored_checksum(name, &dataset)?))
        };
        let (values, stored) = self.world.agree(read())?;
        let sum = sum_of_all(self.world, numbers_checksum(range.start, &values));
        if sum == stored { Ok(Some(values)) } else { Err(self.corrupt(name)) }
    }

    /// This rank's block of the field of this name.
    pub fn lattice<const D: usize>(&self, name: &str, grid: &Grid<D>, field: usize) -> Result<Vec<f64>> {
        let (values, stored) = self.world.agree(self.read_block(name, grid, field))?;
        // the sum is over all ranks, hence the same on all
        if lattice_checksum(self.world, grid, field, &values) != stored {
            return Err(self.corrupt(name));
        }
        Ok(values)
    }

    fn read_block<const D: usize>(&self, name: &str, grid: &Grid<D>, field: usize) -> Result<(Vec<f64>, u64)> {
        let whole = grid.lattice(field);
        let expected: Vec<usize> = slab::ranges(whole, whole).iter().map(|range| range.end).collect();
        let dataset = self.dataset(name)?;
        if dataset.shape() != expected {
            let what = format!("{name} lies on a lattice of {:?} points, the scene needs {expected:?}", dataset.shape());
            return Err(Error::refused(format!(
                "{}: {what}; resume with the size and the resolution of the first run",
                self.path.display()
            )));
        }
        let values = slab::read(&dataset, &slab::ranges(grid.block(field), whole)).map_err(|_| self.corrupt(name))?;
        Ok((values, self.stored_checksum(name, &dataset)?))
    }

    fn alike<T: hdf5::H5Type>(&self, name: &str, bits: impl Fn(&T) -> u64) -> Result<Vec<T>> {
        let read = || {
            let dataset = self.dataset(name)?;
            // the size is believed only if the file is large enough for it
            let fits = dataset.size().saturating_mul(size_of::<T>()) as u64 <= self.file.size();
            let values = if !fits {
                return Err(self.corrupt(name));
            } else if dataset.size() == 0 {
                Vec::new()
            } else {
                dataset.read_raw::<T>().map_err(|_| self.corrupt(name))?
            };
            let sum = checksum(values.iter().map(bits).enumerate());
            if sum == self.stored_checksum(name, &dataset)? { Ok(values) } else { Err(self.corrupt(name)) }
        };
        self.world.agree(read())
    }

    fn dataset(&self, name: &str) -> Result<hdf5::Dataset> {
        self.file.dataset(name).map_err(|_| refused(&self.path, &format!("holds no {name}, or a corrupt one")))
    }

    fn stored_checksum(&self, name: &str, dataset: &hdf5::Dataset) -> Result<u64> {
        slab::get(dataset, "checksum").map_err(|_| self.corrupt(name))
    }

    fn corrupt(&self, name: &str) -> Error {
        refused(&self.path, &format!("{name} is corrupt"))
    }
}

/// The file, or what is wrong with it.
fn open(path: &Path) -> std::result::Result<hdf5::File, String> {
    let metadata = std::fs::metadata(path).map_err(|error| format!("cannot be read ({error})"))?;
    if metadata.len() == 0 {
        return Err("is empty".into());
    }
    let file = hdf5::File::open(path).map_err(|error| {
        let foreign = error.contains_minor(hdf5::MinorErrorCode::NotHdf5);
        if foreign { "is no HDF5 file".to_string() } else { format!("is truncated or corrupt ({error})") }
    })?;
    match slab::get_text(&file, "format") {
        Ok(format) if format == FORMAT => {}
        _ => return Err("is no checkpoint of turbid".into()),
    }
    match slab::get::<u32>(&file, "version") {
        Ok(VERSION) => Ok(file),
        Ok(other) => Err(format!("has version {other} of the checkpoint format, this program reads version {VERSION}")),
        Err(_) => Err("is corrupt: it has no version".into()),
    }
}

fn refused(path: &Path, what: &str) -> Error {
    Refusal::from(format!("checkpoint {}: {what}; resume from another checkpoint", path.display())).offering(Offer::Anew)
}

fn lattice_checksum<const D: usize>(world: &World, grid: &Grid<D>, field: usize, values: &[f64]) -> u64 {
    let whole = grid.lattice(field);
    let places = grid.block(field).indices().map(|index| whole.offset(index));
    sum_of_all(world, checksum(places.zip(values.iter().map(|value| value.to_bits()))))
}
