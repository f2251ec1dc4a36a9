//! Cell list: balls sorted into a grid of cells, to find neighbours at linear cost.
//!
//! The grid has about one cell per ball, and more where balls fill a part of the box only. Each ball looks only for balls not larger than itself, in
//! the cells its search range covers, so that the cost is the number of balls times their volume
//! fraction even when radii differ widely. Periodic images are cells beyond the box.

use nalgebra::SVector;

use super::{Ball, Domain};

/// Balls of a coarse cell where they are spread evenly.
const COARSE: usize = 8;
/// Cells at most, per ball and in all.
const MOST_CELLS_PER_BALL: f64 = 32.0;
const MOST_CELLS: f64 = 1e9;

/// Balls sorted into cells.
pub(super) struct Cells<'a, const D: usize> {
    domain: &'a Domain<D>,
    /// Number of cells along each axis.
    counts: [usize; D],
    /// Where each cell starts in `members`, and one entry past the end.
    starts: Vec<u32>,
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
        let in_box = |ball: &Ball<D>| Ball { center: domain.wrap(ball.center), ..*ball };
        let members = balls.iter().enumerate().map(|(body, ball)| Member { body, ball: in_box(ball) }).collect();
        let mut cells = Self { domain, counts: cell_counts(domain, balls.len() / COARSE), starts: Vec::new(), members };
        cells.counts = cell_counts(domain, cells.enough());
        cells.sort();
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
                let [start, end] = [flat, flat + length as usize].map(|cell| self.starts[cell] as usize);
                action(&self.members[start..end], image);
                cell[0] += length;
            }
        });
    }

    /// How many cells the box needs for one per ball in the part of it that balls fill, which is known from its present, coarse cells.
    fn enough(&self) -> usize {
        let (all, balls) = (self.counts.iter().product::<usize>(), self.members.len());
        let mut filled = vec![false; all];
        self.members.iter().for_each(|member| filled[self.owner(member.ball.center)] = true);
        let filled = filled.into_iter().filter(|&filled| filled).count().max(1);
        (balls as f64 * (all as f64 / filled as f64).min(MOST_CELLS_PER_BALL)).min(MOST_CELLS) as usize
    }

    fn sort(&mut self) {
        let owners: Vec<u32> = self.members.iter().map(|member| self.owner(member.ball.center) as u32).collect();
        let mut next = vec![0; self.counts.iter().product::<usize>()];
        owners.iter().for_each(|&owner| next[owner as usize] += 1);
        let mut sum = 0;
        next.iter_mut().for_each(|count| sum += std::mem::replace(count, sum));
        self.starts = next.iter().copied().chain([sum]).collect();
        let unsorted = self.members.clone();
        for (member, owner) in unsorted.into_iter().zip(owners) {
            let place = &mut next[owner as usize];
            self.members[*place as usize] = member;
            *place += 1;
        }
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
    use crate::geometry::Axis;

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

    /// How many centres are looked at for each of the disks of a square lattice in a corner of a box.
    fn looks_a_ball(side: usize, box_over_corner: f64) -> f64 {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain { size: SVector::repeat(side as f64 * box_over_corner), axes: [Axis::Periodic, wall] };
        let place = |flat: usize| SVector::from([(flat % side) as f64 + 0.5, (flat / side) as f64 + 0.5]);
        let balls: Vec<Ball<2>> = (0..side * side).map(|flat| Ball { center: place(flat), radius: 0.5 }).collect();
        let (cells, mut looks) = (Cells::new(&domain, &balls), 0);
        cells.members().iter().for_each(|member| cells.visit(member.ball.center, 1.1, |_, _, _| looks += 1));
        looks as f64 / balls.len() as f64
    }

    #[test]
    fn looks_a_ball_grow_neither_with_their_number_nor_where_they_leave_most_of_the_box_empty() {
        for (side, box_over_corner) in [(20, 1.0), (80, 1.0), (300, 1.0), (80, 2.0), (80, 5.0), (300, 5.0)] {
            let looks = looks_a_ball(side, box_over_corner);
            assert!(looks > 8.0 && looks < 25.0, "{looks} of {side}^2 in a box {box_over_corner} times as wide");
        }
    }
}
