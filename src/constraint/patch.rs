//! The neighbourhood of one body on the lattice of one field, with a slot for each of its points.

use nalgebra::SVector;

use crate::grid::{Grid, Index};

const EMPTY: u32 = u32::MAX;

/// A box of lattice indices (not wrapped) around a body; each index can be given a slot number.
pub struct Patch<const D: usize> {
    start: Index<D>,
    extent: [usize; D],
    slots: Vec<u32>,
}

impl<const D: usize> Patch<D> {
    /// The lattice of `field` within `reach` of `center` along each axis, clipped at walls.
    pub fn around(grid: &Grid<D>, field: usize, center: &SVector<f64, D>, reach: f64) -> Patch<D> {
        let place = |axis: usize, x: f64| x / grid.spacing()[axis] - grid.stagger(field, axis);
        let mut start: Index<D> = std::array::from_fn(|axis| place(axis, center[axis] - reach).floor() as isize);
        let mut end: Index<D> = std::array::from_fn(|axis| place(axis, center[axis] + reach).ceil() as isize + 1);
        for axis in (0..D).filter(|&axis| !grid.domain().periodic(axis)) {
            let beyond = grid.cells()[axis] as isize + isize::from(field == axis);
            start[axis] = start[axis].max(0);
            end[axis] = end[axis].min(beyond);
        }
        let extent: [usize; D] = std::array::from_fn(|axis| (end[axis] - start[axis]).max(0) as usize);
        Patch { start, extent, slots: vec![EMPTY; extent.iter().product()] }
    }

    /// All its indices, the last axis running fastest.
    pub fn indices(&self) -> impl Iterator<Item = Index<D>> + use<D> {
        let (start, extent) = (self.start, self.extent);
        (0..self.slots.len()).map(move |mut offset| {
            let mut index = start;
            for axis in (0..D).rev() {
                index[axis] += (offset % extent[axis]) as isize;
                offset /= extent[axis];
            }
            index
        })
    }

    /// The slot of an index, if it has one; the index must lie in the patch.
    pub fn find(&self, index: Index<D>) -> Option<usize> {
        let slot = self.slots[self.offset(index)];
        (slot != EMPTY).then_some(slot as usize)
    }

    /// Gives an index a slot.
    pub fn set(&mut self, index: Index<D>, slot: usize) {
        let offset = self.offset(index);
        self.slots[offset] = slot as u32;
    }

    fn offset(&self, index: Index<D>) -> usize {
        (0..D).fold(0, |offset, axis| {
            let place = index[axis] - self.start[axis];
            assert!(place >= 0 && (place as usize) < self.extent[axis], "stencils reach no further than the patch");
            offset * self.extent[axis] + place as usize
        })
    }
}
