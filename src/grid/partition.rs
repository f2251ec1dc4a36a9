//! Which rank owns which cells: a grid of blocks, cut in every direction.

use std::ops::Range;

use crate::error::{Error, Result};

/// A half-open box of lattice indices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block<const D: usize> {
    /// First index along each axis.
    pub start: [usize; D],
    /// One past the last index along each axis.
    pub end: [usize; D],
}

impl<const D: usize> Block<D> {
    /// Number of indices.
    pub fn len(&self) -> usize {
        (0..D).map(|axis| self.end[axis] - self.start[axis]).product()
    }

    /// Whether it holds no index.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The indices that it shares with another block.
    pub fn intersection(&self, other: &Block<D>) -> Block<D> {
        let start = std::array::from_fn(|axis| self.start[axis].max(other.start[axis]));
        Block { start, end: std::array::from_fn(|axis| self.end[axis].min(other.end[axis]).max(start[axis])) }
    }

    /// The places of the indices of `part` in this block, in their order, as the fewest runs of neighbours.
    pub fn runs(&self, part: Block<D>) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        for start in part.flattened(D - 1).indices() {
            let offset = self.offset(start);
            let row = offset..offset + part.end[D - 1] - part.start[D - 1];
            match runs.last_mut() {
                Some(last) if last.end == row.start => last.end = row.end,
                _ => runs.push(row),
            }
        }
        runs.retain(|run| !run.is_empty());
        runs
    }

    /// The first layer along an axis.
    pub fn flattened(mut self, axis: usize) -> Block<D> {
        self.end[axis] = self.start[axis] + 1;
        self
    }

    /// Place of `index` in the block, the last axis running fastest.
    pub fn offset(&self, index: [usize; D]) -> usize {
        (0..D).fold(0, |offset, axis| offset * (self.end[axis] - self.start[axis]) + index[axis] - self.start[axis])
    }

    /// All indices, the last axis running fastest.
    pub fn indices(self) -> impl Iterator<Item = [usize; D]> {
        let mut next = self.start;
        (0..self.len()).map(move |_| {
            let index = next;
            for axis in (0..D).rev() {
                next[axis] += 1;
                if next[axis] < self.end[axis] {
                    break;
                }
                next[axis] = self.start[axis];
            }
            index
        })
    }

    /// The index at a place in the block.
    pub fn index(&self, mut offset: usize) -> [usize; D] {
        let mut index = [0; D];
        for axis in (0..D).rev() {
            let extent = self.end[axis] - self.start[axis];
            index[axis] = self.start[axis] + offset % extent;
            offset /= extent;
        }
        index
    }
}

/// The cells of the box, cut into one block a rank.
#[derive(Debug, Clone, PartialEq)]
pub struct Partition<const D: usize> {
    cells: [usize; D],
    ranks: [usize; D],
    /// For each cell of an axis, the part of the axis that it lies in.
    parts: [Vec<usize>; D],
}

impl<const D: usize> Partition<D> {
    /// Cuts `cells` into `ranks` blocks with the least surface.
    ///
    /// # Errors
    /// No way of cutting leaves a cell to every block.
    pub fn new(cells: [usize; D], ranks: usize) -> Result<Partition<D>> {
        let best = factorisations::<D>(ranks)
            .into_iter()
            .filter(|factors| (0..D).all(|axis| factors[axis] <= cells[axis]))
            .min_by(|a, b| surface(cells, *a).total_cmp(&surface(cells, *b)));
        let ranks = best.ok_or_else(|| {
            Error::refused(format!(
                "{ranks} ranks do not fit a grid of {cells:?} cells: they cannot be cut into so many blocks; use \
                 fewer ranks, a number of them with small factors, or more cells"
            ))
        })?;
        // the last part whose start part * cells / parts is not beyond the cell
        let part = |axis: usize, cell: usize| ((cell + 1) * ranks[axis] - 1) / cells[axis];
        let parts = std::array::from_fn(|axis| (0..cells[axis]).map(|cell| part(axis, cell)).collect());
        Ok(Partition { cells, ranks, parts })
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.ranks.iter().product()
    }

    /// Number of blocks along each axis.
    pub fn ranks(&self) -> [usize; D] {
        self.ranks
    }

    /// The cells of a rank.
    pub fn block(&self, rank: usize) -> Block<D> {
        let place = Block { start: [0; D], end: self.ranks }.index(rank);
        let cut = |axis: usize, part: usize| part * self.cells[axis] / self.ranks[axis];
        Block { start: std::array::from_fn(|axis| cut(axis, place[axis])), end: std::array::from_fn(|axis| cut(axis, place[axis] + 1)) }
    }

    /// The rank that owns a cell.
    pub fn owner(&self, cell: [usize; D]) -> usize {
        (0..D).fold(0, |rank, axis| rank * self.ranks[axis] + self.parts[axis][cell[axis]])
    }
}

/// All ways of writing a number as an ordered product of `D` factors.
pub fn factorisations<const D: usize>(ranks: usize) -> Vec<[usize; D]> {
    let mut all = vec![([1; D], ranks)];
    for axis in 0..D - 1 {
        all = all
            .into_iter()
            .flat_map(|(factors, left)| {
                (1..=left).filter(move |factor| left % factor == 0).map(move |factor| {
                    let mut factors = factors;
                    factors[axis] = factor;
                    (factors, left / factor)
                })
            })
            .collect();
    }
    all.into_iter()
        .map(|(mut factors, left)| {
            factors[D - 1] = left;
            factors
        })
        .collect()
}

fn surface<const D: usize>(cells: [usize; D], ranks: [usize; D]) -> f64 {
    let extents: [f64; D] = std::array::from_fn(|axis| cells[axis] as f64 / ranks[axis] as f64);
    let volume: f64 = extents.iter().product();
    extents.iter().map(|extent| volume / extent).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_belongs_to_the_block_of_its_owner() {
        for ranks in [1, 2, 3, 5, 6, 7, 12] {
            let partition = Partition::new([14, 17, 15], ranks).unwrap();
            let mut covered = 0;
            for rank in 0..ranks {
                let block = partition.block(rank);
                covered += block.len();
                assert!(block.indices().all(|cell| partition.owner(cell) == rank));
            }
            assert_eq!(covered, 14 * 17 * 15);
        }
    }

    #[test]
    fn blocks_are_cut_along_the_longest_axis() {
        assert_eq!(Partition::new([100, 10], 4).unwrap().ranks(), [4, 1]);
        assert_eq!(Partition::new([40, 40], 4).unwrap().ranks(), [2, 2]);
    }

    #[test]
    fn too_many_ranks_are_refused() {
        let error = Partition::new([4, 4], 7).unwrap_err().to_string();
        assert!(error.contains("7 ranks do not fit a grid of [4, 4] cells"), "{error}");
    }
}
