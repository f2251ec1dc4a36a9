//! Blocks of a lattice as parts of a data set, and small attributes.

use std::ops::Range;

use hdf5::{Dataset, H5Type, Hyperslab, Location, Result, SliceOrIndex, types::FixedAscii};
use ndarray::{ArrayViewD, IxDyn};

use crate::grid::Block;

/// Longest name of a file format.
const NAME_LENGTH: usize = 64;

/// The ranges of `block` within `whole`.
pub fn ranges<const D: usize>(block: Block<D>, whole: Block<D>) -> Vec<Range<usize>> {
    (0..D).map(|axis| block.start[axis] - whole.start[axis]..block.end[axis] - whole.start[axis]).collect()
}

/// Writes the values at the given ranges of a data set, the last running fastest.
pub fn write<T: H5Type>(dataset: &Dataset, ranges: &[Range<usize>], values: &[T]) -> Result<()> {
    let shape: Vec<usize> = ranges.iter().map(ExactSizeIterator::len).collect();
    let view = ArrayViewD::from_shape(IxDyn(&shape), values).map_err(|error| error.to_string())?;
    dataset.write_slice(view, slab(ranges))
}

/// Reads the values at the given ranges of a data set, the last running fastest.
pub fn read(dataset: &Dataset, ranges: &[Range<usize>]) -> Result<Vec<f64>> {
    Ok(dataset.read_slice::<f64, _, IxDyn>(slab(ranges))?.into_iter().collect())
}

/// Writes one number beside the data.
pub fn set<T: H5Type>(place: &Location, name: &str, value: T) -> Result<()> {
    place.new_attr::<T>().create(name)?.write_scalar(&value)
}

/// Writes a few numbers beside the data.
pub fn set_all<T: H5Type>(place: &Location, name: &str, values: &[T]) -> Result<()> {
    place.new_attr::<T>().shape(values.len()).create(name)?.write_raw(values)
}

/// Writes a short ASCII text beside the data.
pub fn set_text(place: &Location, name: &str, text: &str) -> Result<()> {
    let text = FixedAscii::<NAME_LENGTH>::from_ascii(text).map_err(|error| error.to_string())?;
    set(place, name, text)
}

/// Reads one number from beside the data.
pub fn get<T: H5Type>(place: &Location, name: &str) -> Result<T> {
    place.attr(name)?.read_scalar()
}

/// Reads a short ASCII text from beside the data.
pub fn get_text(place: &Location, name: &str) -> Result<String> {
    Ok(get::<FixedAscii<NAME_LENGTH>>(place, name)?.as_str().to_owned())
}

fn slab(ranges: &[Range<usize>]) -> Hyperslab {
    Hyperslab::from(ranges.iter().cloned().map(SliceOrIndex::from).collect::<Vec<_>>())
}
