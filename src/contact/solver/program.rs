//! The quadratic program of an island, free of units: `min 1/2 |x|^2` subject to `A x + c >= 0`.
//!
//! Its solution is `x = A^T z` with multipliers `z >= 0` and slacks `s = A x + c >= 0` of which one is zero
//! in each row. Rows of `A` have norm 1. This module knows matrices only, neither bodies nor contacts.

use clarabel::algebra::CscMatrix;

use super::sharing::Sharing;
use crate::linalg::dot;

/// A program whose unknowns are the multipliers. Ranks may share one: each then has the constraints of its own bodies, of which it knows all
/// unknowns, and everything below is collective.
pub struct Program<'a> {
    /// `A^T`: one column for each constraint.
    pub transposed: CscMatrix<f64>,
    /// Unknowns of a body, which follow each other; a constraint has entries in all of those of one or two bodies.
    pub width: usize,
    /// `c`.
    pub offsets: Vec<f64>,
    /// With whom it is shared, if it is.
    pub sharing: Option<&'a Sharing<'a>>,
}

impl Program<'_> {
    /// The entries of `A` in the row of a constraint: places and values.
    pub fn row(&self, constraint: usize) -> impl Iterator<Item = (usize, f64)> {
        let CscMatrix { colptr, rowval, nzval, .. } = &self.transposed;
        (colptr[constraint]..colptr[constraint + 1]).map(|entry| (rowval[entry], nzval[entry]))
    }

    /// The entries of `A` in the row of a constraint, one body after the other.
    pub fn values(&self, constraint: usize) -> &[f64] {
        &self.transposed.nzval[self.transposed.colptr[constraint]..self.transposed.colptr[constraint + 1]]
    }

    /// The two bodies of a constraint; the same twice if it has one.
    pub fn bodies(&self, constraint: usize) -> [usize; 2] {
        let CscMatrix { colptr, rowval, .. } = &self.transposed;
        [colptr[constraint], colptr[constraint + 1] - 1].map(|entry| rowval[entry] / self.width)
    }

    /// `x = A^T z`.
    pub fn apply_transpose(&self, multipliers: &[f64], unknowns: &mut [f64]) {
        unknowns.fill(0.0);
        match self.width {
            2 => self.add_transpose::<2>(multipliers, unknowns),
            3 => self.add_transpose::<3>(multipliers, unknowns),
            width => panic!("bodies move along 2 or 3 axes, not {width}"),
        }
        if let Some(sharing) = self.sharing {
            sharing.update(unknowns, self.width);
        }
    }

    fn add_transpose<const D: usize>(&self, multipliers: &[f64], unknowns: &mut [f64]) {
        let blocks = unknowns.as_chunks_mut::<D>().0;
        for (constraint, multiplier) in multipliers.iter().enumerate() {
            for (body, values) in self.blocks::<D>(constraint) {
                (0..D).for_each(|axis| blocks[body][axis] += values[axis] * multiplier);
            }
        }
    }

    /// `A x`.
    pub fn apply(&self, unknowns: &[f64], changes: &mut [f64]) {
        match self.width {
            2 => self.set_changes::<2>(unknowns, changes),
            3 => self.set_changes::<3>(unknowns, changes),
            width => panic!("bodies move along 2 or 3 axes, not {width}"),
        }
    }

    fn set_changes<const D: usize>(&self, unknowns: &[f64], changes: &mut [f64]) {
        let blocks = unknowns.as_chunks::<D>().0;
        for (constraint, change) in changes.iter_mut().enumerate() {
            let of_body = |(body, values): (usize, &[f64; D])| -> f64 { (0..D).map(|axis| values[axis] * blocks[body][axis]).sum() };
            *change = self.blocks::<D>(constraint).map(of_body).sum();
        }
    }

    /// The bodies of a constraint, each with its entries.
    fn blocks<const D: usize>(&self, constraint: usize) -> impl Iterator<Item = (usize, &[f64; D])> {
        let CscMatrix { colptr, rowval, nzval, .. } = &self.transposed;
        let (start, end) = (colptr[constraint], colptr[constraint + 1]);
        let places = rowval[start..end].as_chunks::<D>().0;
        places.iter().map(|places| places[0] / D).zip(nzval[start..end].as_chunks::<D>().0)
    }

    /// `s = A A^T z + c`.
    pub fn slacks(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut unknowns = vec![0.0; self.transposed.m];
        let mut slacks = vec![0.0; self.offsets.len()];
        self.apply_transpose(multipliers, &mut unknowns);
        self.apply(&unknowns, &mut slacks);
        slacks.iter_mut().zip(&self.offsets).for_each(|(slack, offset)| *slack += offset);
        slacks
    }

    /// Whether multipliers, none negative, leave no slack below `-tolerance`, and do no more work than that part on slacks.
    pub fn solved(&self, multipliers: &[f64], tolerance: f64) -> bool {
        let slacks = self.slacks(multipliers);
        let work = -self.dot(&self.offsets, multipliers);
        let idle = self.dot(&slacks, multipliers).abs();
        !self.any(slacks.iter().any(|slack| slack.is_nan() || *slack < -tolerance)) && idle <= tolerance * work.max(1.0)
    }

    /// Distance from the solution: the largest `|min(z, s)|`.
    pub fn residual(&self, multipliers: &[f64]) -> f64 {
        let slacks = self.slacks(multipliers);
        self.max(slacks.iter().zip(multipliers).map(|(slack, multiplier)| slack.min(*multiplier).abs()).fold(0.0, f64::max))
    }

    /// The number of constraints.
    pub fn count(&self) -> f64 {
        self.sharing.map_or(self.offsets.len() as f64, Sharing::count)
    }

    /// The sum of products, one for each constraint.
    pub fn dot(&self, one: &[f64], other: &[f64]) -> f64 {
        if self.sharing.is_some() { self.sum(one.iter().zip(other).map(|(one, other)| one * other)) } else { dot(one, other) }
    }

    /// The sum of numbers, one for each constraint.
    pub fn sum(&self, numbers: impl Iterator<Item = f64>) -> f64 {
        match self.sharing {
            Some(sharing) => sharing.sum(numbers),
            None => numbers.sum(),
        }
    }

    /// The largest of the numbers of all ranks.
    pub fn max(&self, number: f64) -> f64 {
        self.sharing.map_or(number, |sharing| sharing.peers().max(number))
    }

    /// Whether it is so on any rank.
    pub fn any(&self, so: bool) -> bool {
        self.max(f64::from(so)) > 0.0
    }
}

/// What a method found.
pub struct Answer {
    /// The multipliers.
    pub multipliers: Vec<f64>,
    /// Iterations of the method.
    pub iterations: usize,
    /// Whether it found that no unknowns meet all constraints.
    pub infeasible: bool,
}

/// Makes negative multipliers zero.
pub fn clip(multipliers: &mut [f64]) {
    multipliers.iter_mut().for_each(|multiplier| *multiplier = multiplier.max(0.0));
}
