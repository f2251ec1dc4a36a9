//! Checksums of numbers at their places: they do not depend on who holds which of them, nor on the order in which they are added.

use std::ops::Range;

use hdf5::Dataset;

use super::slab;
use crate::parallel::World;

/// The attribute of a data set that holds its checksum.
pub const CHECKSUM: &str = "checksum";

/// Numbers of a data set that are read at once.
const AT_ONCE: usize = 1 << 20;

/// A number that differs, but for one case in 1e19, for texts that differ; the same on every machine.
pub fn checksum_of(text: &str) -> u64 {
    checksum(text.bytes().map(u64::from).enumerate())
}

/// The checksum of numbers of which those from a place on are given.
pub fn numbers_checksum(start: usize, values: &[f64]) -> u64 {
    checksum((start..).zip(values.iter().map(|value| value.to_bits())))
}

/// A sum over places and their contents in which any one change shows, in whatever order they are added.
pub fn checksum(entries: impl Iterator<Item = (usize, u64)>) -> u64 {
    entries.map(|(place, bits)| scrambled(scrambled(place as u64) ^ bits)).fold(0, u64::wrapping_add)
}

/// The checksum of all ranks' entries. Collective.
pub fn sum_of_all(world: &World, sum: u64) -> u64 {
    world.gather(&[sum]).into_iter().fold(0, u64::wrapping_add)
}

/// As [`sum_of_all`], of several.
pub fn sums_of_all(world: &World, sums: &[u64]) -> Vec<u64> {
    let mut all = vec![0u64; sums.len()];
    let gathered = world.gather(sums);
    gathered.chunks_exact(sums.len().max(1)).for_each(|own| all.iter_mut().zip(own).for_each(|(sum, own)| *sum = sum.wrapping_add(*own)));
    all
}

/// Whether a data set of numbers, whole or not, is as its checksum has it; nothing without one, as in files of earlier versions.
pub fn intact(dataset: &Dataset) -> hdf5::Result<Option<bool>> {
    let Some(stored) = stored(dataset)? else { return Ok(None) };
    if dataset.size() == 0 {
        // an empty selection cannot be read
        return Ok(Some(stored == 0));
    }
    let shape = dataset.shape();
    // in parts of whole layers, so that a large field takes no memory
    let axis = shape.iter().position(|extent| *extent > 1).unwrap_or(0);
    let layer: usize = shape[axis + 1..].iter().product();
    let step = (AT_ONCE / layer.max(1)).max(1);
    let mut sum = 0u64;
    for start in (0..shape[axis]).step_by(step) {
        let part = |(place, extent): (usize, &usize)| if place == axis { start..(start + step).min(*extent) } else { 0..*extent };
        let ranges: Vec<Range<usize>> = shape.iter().enumerate().map(part).collect();
        sum = sum.wrapping_add(numbers_checksum(start * layer, &slab::read(dataset, &ranges)?));
    }
    Ok(Some(sum == stored))
}

/// The checksum that stands beside a data set.
pub fn stored(dataset: &Dataset) -> hdf5::Result<Option<u64>> {
    let there = dataset.attr_names()?.iter().any(|name| name == CHECKSUM);
    there.then(|| slab::get(dataset, CHECKSUM)).transpose()
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014, doi:10.1145/2660193.2660195): a bijection without pattern.
fn scrambled(value: u64) -> u64 {
    let mut value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}
