//! A bond in a frame: a line between two bodies of a chain, a cell or a cluster.

use nalgebra::SVector;

use super::body::in_space;

/// A bond at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameBond<const D: usize> {
    /// The bodies.
    pub bodies: [usize; 2],
    /// Number of its chain, cell or cluster, chains and cells first.
    pub chain: usize,
    /// Centre of the first body; a periodic image of it in the box is stored.
    pub from: SVector<f64, D>,
    /// From there to the centre of the other, which may lie outside the box.
    pub way: SVector<f64, D>,
}

/// A named vector of each of the two ends.
pub(super) const COLUMNS: [(&str, usize); 1] = [("point", 3)];
/// Named whole numbers of each end: the body, and the number of the chain.
pub(super) const COUNTS: [(&str, usize); 2] = [("body", 1), ("chain", 1)];
/// The number of each end, two ends a bond.
pub(super) const NODE: &str = "node";
/// Numbers of a row, which is an end: the first body of the bond, the entries of [`COUNTS`] and those of [`COLUMNS`].
pub(super) const WIDTH: usize = 6;

impl<const D: usize> FrameBond<D> {
    /// Adds the rows of both ends.
    pub(super) fn add_rows(&self, rows: &mut Vec<f64>) {
        for (body, point) in self.bodies.into_iter().zip([self.from, self.from + self.way]) {
            rows.extend([self.bodies[0] as f64, body as f64, self.chain as f64]);
            rows.extend(in_space(&point));
        }
    }
}
