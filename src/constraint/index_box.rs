//! The neighbourhood of one body on the lattice of one field.

use nalgebra::SVector;

use crate::grid::{Grid, Index};

/// A box of lattice indices (not wrapped) around a body; their places run from 0, the last axis fastest.
pub struct IndexBox<const D: usize> {
    start: Index<D>,
    extent: [usize; D],
}

impl<const D: usize> IndexBox<D> {
    /// The lattice of `field` within `reach` of `center` along each axis, clipped at walls.
    pub fn around(grid: &Grid<D>, field: usize, center: &SVector<f64, D>, reach: f64) -> IndexBox<D> {
        IndexBox::clipped(grid, field, center, reach, |axis| (0, grid.cells()[axis] as isize + isize::from(field == axis)))
    }

    /// As [`around`](Self::around), with the indices beyond the last ones of a velocity component: they stand for walls between lattice points.
    pub fn with_walls(grid: &Grid<D>, field: usize, center: &SVector<f64, D>, reach: f64) -> IndexBox<D> {
        IndexBox::clipped(grid, field, center, reach, |axis| {
            let beyond = isize::from(field < D && field != axis);
            (-beyond, grid.cells()[axis] as isize + isize::from(field < D))
        })
    }

    /// From first indices to those beyond the last ones.
    pub fn between(start: Index<D>, end: Index<D>) -> IndexBox<D> {
        IndexBox { start, extent: std::array::from_fn(|axis| (end[axis] - start[axis]).max(0) as usize) }
    }

    /// Cell centres within `reach` of `center` along each axis, with the indices beyond the last ones: they stand for walls.
    pub fn of_cells(grid: &Grid<D>, center: &SVector<f64, D>, reach: f64) -> IndexBox<D> {
        IndexBox::clipped(grid, D, center, reach, |axis| (-1, grid.cells()[axis] as isize + 1))
    }

    fn clipped(
        grid: &Grid<D>,
        field: usize,
        center: &SVector<f64, D>,
        reach: f64,
        limits: impl Fn(usize) -> (isize, isize),
    ) -> IndexBox<D> {
        let center = grid.straightened(*center);
        let reach = |axis: usize| if axis == 0 { reach * (1.0 + grid.slope().abs()) } else { reach };
        let place = |axis: usize, x: f64| x / grid.spacing()[axis] - grid.stagger(field, axis);
        let mut start: Index<D> = std::array::from_fn(|axis| place(axis, center[axis] - reach(axis)).floor() as isize);
        let mut end: Index<D> = std::array::from_fn(|axis| place(axis, center[axis] + reach(axis)).ceil() as isize + 1);
        for axis in (0..D).filter(|&axis| !grid.domain().periodic(axis)) {
            let (first, beyond) = limits(axis);
            start[axis] = start[axis].max(first);
            end[axis] = end[axis].min(beyond);
        }
        IndexBox::between(start, end)
    }

    /// First index along each axis.
    pub fn start(&self) -> Index<D> {
        self.start
    }

    /// Number of indices along each axis.
    pub fn extent(&self) -> [usize; D] {
        self.extent
    }

    /// Number of indices.
    pub fn len(&self) -> usize {
        self.extent.iter().product()
    }

    /// Whether it has no index.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Distance between the places of neighbours along each axis.
    pub fn strides(&self) -> [usize; D] {
        std::array::from_fn(|axis| self.extent[axis + 1..].iter().product())
    }

    /// All its indices, in the order of their places.
    pub fn indices(&self) -> impl Iterator<Item = Index<D>> + use<D> {
        let (start, extent, mut next) = (self.start, self.extent, self.start);
        (0..self.len()).map(move |_| {
            let index = next;
            for axis in (0..D).rev() {
                next[axis] += 1;
                if next[axis] < start[axis] + extent[axis] as isize {
                    break;
                }
                next[axis] = start[axis];
            }
            index
        })
    }

    /// The index at a place.
    pub fn index(&self, place: usize) -> Index<D> {
        index_at(self.start, self.extent, place)
    }

    /// The place of an index, which must lie in the box of indices.
    pub fn place(&self, index: Index<D>) -> usize {
        (0..D).fold(0, |place, axis| {
            let along = index[axis] - self.start[axis];
            assert!(along >= 0 && (along as usize) < self.extent[axis], "stencils reach no further than the box of indices");
            place * self.extent[axis] + along as usize
        })
    }
}

fn index_at<const D: usize>(start: Index<D>, extent: [usize; D], place: usize) -> Index<D> {
    let (mut index, mut rest) = (start, place as u32);
    for axis in (0..D).rev() {
        let extent = extent[axis] as u32;
        index[axis] += (rest % extent) as isize;
        rest /= extent;
    }
    index
}
