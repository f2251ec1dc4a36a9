//! Balls sorted by size into grids of hashed cells: who lies where, at linear cost however the balls cluster.
//!
//! Each power of two of the radii has a grid whose cells are as wide as its largest balls, so that what touches a ball not larger than
//! these lies in the cells next to its own. Balls that do not overlap are few in a cell; whoever stops at the first overlap visits few.

use std::collections::{BTreeMap, HashMap};

use nalgebra::SVector;

use super::{Ball, Domain};

/// Most cells along an axis: beyond it their numbers are not exact.
const MOST_CELLS: f64 = 1e15;

/// Balls sorted by size and place.
pub struct Levels<'a, const D: usize> {
    domain: &'a Domain<D>,
    /// By the binary logarithm of the radii, rounded up.
    levels: BTreeMap<i32, CellLevel<D>>,
}

/// Balls of about one size.
struct CellLevel<const D: usize> {
    /// Number of cells along each axis.
    counts: [f64; D],
    /// Cells along each axis within which a ball of this level is touched.
    reach: [i64; D],
    /// The place among the members of the last that came into each cell.
    last: HashMap<[i64; D], u32>,
    members: Vec<Member<D>>,
    /// Places of members that were taken out.
    free: Vec<u32>,
}

/// A ball in a cell.
struct Member<const D: usize> {
    number: usize,
    /// Its centre, moved into the box.
    center: SVector<f64, D>,
    /// The place of the one that came into the cell before it, or [`NONE`].
    before: u32,
}

/// No place.
const NONE: u32 = u32::MAX;

impl<'a, const D: usize> Levels<'a, D> {
    /// No balls yet.
    pub fn new(domain: &'a Domain<D>) -> Self {
        Levels { domain, levels: BTreeMap::new() }
    }

    /// Adds a ball, which is known by a number.
    pub fn insert(&mut self, number: usize, ball: &Ball<D>) {
        let exponent = exponent(ball.radius);
        let level = self.levels.entry(exponent).or_insert_with(|| CellLevel::new(self.domain, exponent));
        level.insert(self.domain, number, self.domain.wrap(ball.center));
    }

    /// Takes out a ball that was added with this number.
    pub fn remove(&mut self, number: usize, ball: &Ball<D>) {
        if let Some(level) = self.levels.get_mut(&exponent(ball.radius)) {
            level.remove(self.domain, number, &self.domain.wrap(ball.center));
        }
    }

    /// Calls `found(number, distance of the centres)` for each image of a ball near one that is not larger than it.
    ///
    /// Smaller balls that were added may be missed.
    pub fn visit(&self, ball: &Ball<D>, mut found: impl FnMut(usize, f64)) {
        let center = self.domain.wrap(ball.center);
        for (_, level) in self.levels.range(exponent(ball.radius)..) {
            level.visit(self.domain, &center, level.reach, &mut found);
        }
    }

    /// Calls `found(number)` for each image of a ball, of any size, whose centre may be nearer to that of a ball than `factor` times the sum of
    /// their radii.
    pub fn visit_within(&self, ball: &Ball<D>, factor: f64, mut found: impl FnMut(usize)) {
        let center = self.domain.wrap(ball.center);
        for (&exponent, level) in &self.levels {
            let range = factor * (ball.radius + largest(exponent)) * (1.0 + 1e-9);
            let reach = std::array::from_fn(|axis| (range * level.counts[axis] / self.domain.size[axis]).ceil() as i64);
            level.visit(self.domain, &center, reach, &mut |number, _| found(number));
        }
    }
}

impl<const D: usize> CellLevel<D> {
    fn new(domain: &Domain<D>, exponent: i32) -> Self {
        let edge = 2.0 * largest(exponent);
        let counts: [f64; D] = std::array::from_fn(|axis| (domain.size[axis] / edge).floor().clamp(1.0, MOST_CELLS));
        let reach = std::array::from_fn(|axis| (edge * counts[axis] / domain.size[axis] * (1.0 - 1e-9)).ceil().max(1.0) as i64);
        CellLevel { counts, reach, last: HashMap::new(), members: Vec::new(), free: Vec::new() }
    }

    fn insert(&mut self, domain: &Domain<D>, number: usize, center: SVector<f64, D>) {
        let last = self.last.entry(inside(self.cell(domain, &center), &self.counts)).or_insert(NONE);
        let member = Member { number, center, before: *last };
        match self.free.pop() {
            Some(place) => {
                *last = place;
                self.members[place as usize] = member;
            }
            None => {
                *last = self.members.len() as u32;
                self.members.push(member);
            }
        }
    }

    fn remove(&mut self, domain: &Domain<D>, number: usize, center: &SVector<f64, D>) {
        let cell = inside(self.cell(domain, center), &self.counts);
        let Some(last) = self.last.get_mut(&cell) else { return };
        let (mut place, mut after) = (*last, NONE);
        while place != NONE && self.members[place as usize].number != number {
            (after, place) = (place, self.members[place as usize].before);
        }
        if place == NONE {
            return;
        }
        let before = self.members[place as usize].before;
        match after {
            NONE => *last = before,
            _ => self.members[after as usize].before = before,
        }
        self.free.push(place);
    }

    /// Calls `found` for the members of a cell.
    fn visit_cell(&self, cell: &[i64; D], mut found: impl FnMut(&Member<D>)) {
        let mut place = self.last.get(cell).copied().unwrap_or(NONE);
        while place != NONE {
            let member = &self.members[place as usize];
            found(member);
            place = member.before;
        }
    }

    /// The cell of a point, which lies beyond the box if the point does.
    fn cell(&self, domain: &Domain<D>, point: &SVector<f64, D>) -> [i64; D] {
        std::array::from_fn(|axis| (point[axis] / domain.size[axis] * self.counts[axis]).floor() as i64)
    }

    /// Visits the cells so many to each side of a point along each axis.
    fn visit(&self, domain: &Domain<D>, center: &SVector<f64, D>, reach: [i64; D], found: &mut impl FnMut(usize, f64)) {
        let rows = self.cell(domain, center)[1];
        for row in rows - reach[1]..=rows + reach[1] {
            let (up, row) = turns(domain, 1, row, self.counts[1] as i64);
            // seen from a row of images, the centre lies aside
            let aside = domain.offset(std::array::from_fn(|axis| if axis == 1 { up as isize } else { 0 }))[0];
            let own = self.cell(domain, &SVector::from_fn(|axis, _| if axis == 0 { center[0] - aside } else { center[axis] }));
            for flat in 0..(0..D).filter(|&axis| axis != 1).map(|axis| 2 * reach[axis] + 1).product() {
                let (place, image) = self.place(domain, own, reach, [row, up], flat);
                let offset = domain.offset(image.map(|turns| turns as isize));
                self.visit_cell(&place, |member| found(member.number, (member.center + offset - center).norm()));
            }
        }
    }

    /// One of the cells of a row around a cell, and the image of the box in which it lies.
    fn place(&self, domain: &Domain<D>, own: [i64; D], reach: [i64; D], [row, up]: [i64; 2], mut flat: i64) -> ([i64; D], [i64; D]) {
        let (mut place, mut image) = ([row; D], [up; D]);
        for axis in (0..D).filter(|&axis| axis != 1) {
            let width = 2 * reach[axis] + 1;
            let cell = own[axis] + flat % width - reach[axis];
            (image[axis], place[axis]) = turns(domain, axis, cell, self.counts[axis] as i64);
            flat /= width;
        }
        (place, image)
    }
}

/// A cell, or the one of the box next to it.
fn inside<const D: usize>(cell: [i64; D], counts: &[f64; D]) -> [i64; D] {
    std::array::from_fn(|axis| cell[axis].clamp(0, counts[axis] as i64 - 1))
}

/// How many boxes away a cell lies along an axis, and its image in the box; along walls it stays where it is.
fn turns<const D: usize>(domain: &Domain<D>, axis: usize, cell: i64, count: i64) -> (i64, i64) {
    if domain.periodic(axis) { (cell.div_euclid(count), cell.rem_euclid(count)) } else { (0, cell) }
}

/// The largest radius of a level.
fn largest(exponent: i32) -> f64 {
    2.0_f64.powi(exponent)
}

/// The least power of two that is not below a radius.
fn exponent(radius: f64) -> i32 {
    radius.log2().ceil() as i32
}
