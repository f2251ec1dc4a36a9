//! Cell list: balls sorted into a grid of cells, to find neighbours at linear cost.
//!
//! The grid has about one cell per ball. Each ball looks only for balls not larger than itself, in
//! the cells its search range covers, so that the cost is the number of balls times their volume
//! fraction even when radii differ widely. Periodic images are cells beyond the box.

use nalgebra::SVector;

use super::{Ball, Domain};

/// Balls sorted into cells.
pub(super) struct Cells<'a, const D: usize> {
    domain: &'a Domain<D>,
    /// Number of cells along each axis.
    counts: [usize; D],
    /// Where each cell starts in `members`, and one entry past the end.
    starts: Vec<usize>,
    /// The balls, cell after cell: those near each other lie near each other in memory.
    members: Vec<Member<D>>,
}

/// A ball in a cell.
#[derive(Clone, Copy)]
pub(super) struct Member<const D: usize> {
    /// Its index.
    pub body: usize,
    /// The ball, its centre moved into the box along periodic axes.
    pub ball: Ball<D>,
}

impl<'a, const D: usize> Cells<'a, D> {
    /// Sorts `balls` into cells.
    pub fn new(domain: &'a Domain<D>, balls: &[Ball<D>]) -> Self {
        let mut cells = Self { domain, counts: cell_counts(domain, balls.len()), starts: Vec::new(), members: Vec::new() };
        cells.sort(balls);
        cells
    }

    /// All balls, cell after cell.
    pub fn members(&self) -> &[Member<D>] {
        &self.members
    }

    /// Calls `found(other, image, separation)` for each ball, image included, with its centre in the cells within
    /// `range` of a centre in the box; `image` counts the boxes it was moved by ([`Domain::offset`]).
    pub fn visit(&self, center: SVector<f64, D>, range: f64, mut found: impl FnMut(&Member<D>, [isize; D], SVector<f64, D>)) {
        // rounding must not hide a pair that sits on a cell face
        let range = SVector::repeat(range * (1.0 + 1e-9));
        let (lower, upper, rows) = (center - range, center + range, self.counts[1] as isize);
        for row in self.cell(lower)[1].div_euclid(rows)..=self.cell(upper)[1].div_euclid(rows) {
            // seen from a row of images, the centre lies aside
            let aside = self.domain.offset(std::array::from_fn(|axis| if axis == 1 { row } else { 0 }));
            let [mut first, mut last] = [lower, upper].map(|corner| {
                self.cell(SVector::from_fn(|axis, _| match axis {
                    0 => corner[0] - aside[0],
                    _ => corner[axis],
                }))
            });
            (first[1], last[1]) = (first[1].max(row * rows), last[1].min((row + 1) * rows - 1));
            self.for_each_run(first, last, |members, image| {
                let offset = self.domain.offset(image);
                for other in members {
                    found(other, image, other.ball.center - center + offset);
                }
            });
        }
    }

    /// Calls `action(members, image)` for each run of cells along the first axis within one image of the box, between two corners.
    fn for_each_run(&self, first: [isize; D], last: [isize; D], mut action: impl FnMut(&[Member<D>], [isize; D])) {
        let (columns, mut end) = (self.counts[0] as isize, last);
        end[0] = first[0];
        for_each_index(first, end, |mut cell| {
            while cell[0] <= last[0] {
                let (flat, image) = self.wrap(cell);
                let length = (last[0] + 1).min((image[0] + 1) * columns) - cell[0];
                action(&self.members[self.starts[flat]..self.starts[flat + length as usize]], image);
                cell[0] += length;
            }
        });
    }

    fn sort(&mut self, balls: &[Ball<D>]) {
        let members: Vec<Member<D>> = balls
            .iter()
            .enumerate()
            .map(|(body, ball)| Member { body, ball: Ball { center: self.domain.wrap(ball.center), ..*ball } })
            .collect();
        let owners: Vec<usize> = members.iter().map(|member| self.owner(member.ball.center)).collect();
        let mut starts = vec![0; self.counts.iter().product::<usize>() + 1];
        for &owner in &owners {
            starts[owner + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        self.members = members.clone();
        let mut next = starts.clone();
        for (member, owner) in members.into_iter().zip(owners) {
            self.members[next[owner]] = member;
            next[owner] += 1;
        }
        self.starts = starts;
    }

    /// Flat index of the cell that holds a wrapped centre.
    fn owner(&self, center: SVector<f64, D>) -> usize {
        let cell = self.cell(center);
        (0..D).rev().fold(0, |flat, axis| flat * self.counts[axis] + cell[axis].clamp(0, self.counts[axis] as isize - 1) as usize)
    }

    /// Cell of a point: beyond the box along periodic axes, in the outermost cell along walled ones.
    fn cell(&self, point: SVector<f64, D>) -> [isize; D] {
        std::array::from_fn(|axis| {
            let count = self.counts[axis];
            let cell = (point[axis] / self.domain.size[axis] * count as f64).floor() as isize;
            if self.domain.periodic(axis) { cell } else { cell.clamp(0, count as isize - 1) }
        })
    }

    /// Flat index of a cell that may lie beyond the box, and the image of the box it lies in.
    fn wrap(&self, cell: [isize; D]) -> (usize, [isize; D]) {
        let image = std::array::from_fn(|axis| cell[axis].div_euclid(self.counts[axis] as isize));
        let flat = (0..D).rev().fold(0, |flat, axis| flat * self.counts[axis] + cell[axis].rem_euclid(self.counts[axis] as isize) as usize);
        (flat, image)
    }
}

/// Cells per axis: nearly cubic cells, about as many as there are balls.
fn cell_counts<const D: usize>(domain: &Domain<D>, balls: usize) -> [usize; D] {
    let most = balls.max(1);
    let edge = (domain.volume() / most as f64).powf(1.0 / D as f64);
    let mut counts = std::array::from_fn(|axis| ((domain.size[axis] / edge) as usize).clamp(1, most));
    while counts.iter().product::<usize>() > 4 * most {
        counts = counts.map(|count| count.div_ceil(2));
    }
    counts
}

/// Calls `action` for each index between two corners, both included.
fn for_each_index<const D: usize>(lower: [isize; D], upper: [isize; D], mut action: impl FnMut([isize; D])) {
    if (0..D).any(|axis| lower[axis] > upper[axis]) {
        return;
    }
    let mut index = lower;
    loop {
        action(index);
        let Some(axis) = (0..D).find(|&axis| index[axis] < upper[axis]) else {
            return;
        };
        index[..axis].copy_from_slice(&lower[..axis]);
        index[axis] += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_of_a_block_comes_once() {
        let mut indices = Vec::new();
        for_each_index([-1, 0, 2], [1, 1, 2], |index| indices.push(index));
        assert_eq!(indices.len(), 6);
        indices.sort();
        indices.dedup();
        assert_eq!(indices.len(), 6);
    }

    #[test]
    fn an_empty_block_has_no_index() {
        for_each_index([0, 1], [3, 0], |_| panic!("the block is empty"));
    }
}
