//! The block J of one body: cubic interpolation of the velocity at the points of its surface.
//!
//! Along each axis there are four nodes with their weights; for each component they differ only in whether the lattice
//! has its points on faces or between them. The nodes around the body are copied, run by run, to a small box without gaps.

use super::places::{Entries, Places};
use crate::{linalg::vectorized, petsc::PetscIndex};

/// Nodes per axis.
pub const NODES: usize = 4;

/// Weights of the nodes of one axis.
pub type StencilWeights = [f64; NODES];

/// Entries that follow each other in a fluid vector and in the box.
#[derive(Debug, Clone, Copy)]
pub struct NodeRun {
    /// First of them in the box.
    pub start: u32,
    /// Number of them.
    pub length: u32,
    /// First of them in fluid vectors.
    pub unknown: PetscIndex,
    /// Once planned, its place.
    pub place: u32,
}

/// The nodes around a body on the lattice of one component.
pub struct NodeBox<const D: usize> {
    /// The lattice.
    pub lattice: usize,
    /// Number of nodes of the box; those in no run are zero.
    pub length: usize,
    /// Distance between neighbours along each axis; 1 along the last.
    pub strides: [usize; D],
    /// What to fetch.
    pub runs: Vec<NodeRun>,
    /// For each point, the first of its nodes.
    pub corners: Vec<u32>,
}

/// The weights of the nodes of every point: for each axis, of nodes on its faces and of nodes between them.
pub enum PointWeights<const D: usize> {
    /// Nodes are equally spaced: where the point lies after the second of them, in spacings. The weights are made anew where they are used.
    Even(Vec<[[f64; 2]; D]>),
    /// Some nodes are points of a wall: the weights.
    AtWall(Vec<[[StencilWeights; 2]; D]>),
}

impl<const D: usize> PointWeights<D> {
    /// Along each axis those of one point, for a lattice whose own axis is given.
    #[inline(always)]
    pub fn of(&self, point: usize, lattice: usize) -> [StencilWeights; D] {
        let kind = |axis: usize| usize::from(axis != lattice);
        match self {
            PointWeights::Even(parts) => std::array::from_fn(|axis| cubic_weights(parts[point][axis][kind(axis)])),
            PointWeights::AtWall(weights) => std::array::from_fn(|axis| weights[point][axis][kind(axis)]),
        }
    }
}

/// Weights of four equally spaced nodes for a point this far, in spacings, after the second.
#[inline(always)]
fn cubic_weights(part: f64) -> StencilWeights {
    let (first, third, fourth) = (part + 1.0, part - 1.0, part - 2.0);
    let (before, after) = (first * part, third * fourth);
    [part * after * (-1.0 / 6.0), first * after * 0.5, before * fourth * -0.5, before * third * (1.0 / 6.0)]
}

/// Interpolation at the points of a surface.
pub struct Interpolant<const D: usize> {
    /// For each component.
    pub boxes: Vec<NodeBox<D>>,
    /// Weights of the nodes.
    pub weights: PointWeights<D>,
    /// What moving walls add to each component of each point; empty if no wall is near.
    pub wall_values: Vec<f64>,
}

impl<const D: usize> Interpolant<D> {
    /// Finds the places of the runs.
    pub fn plan(&mut self, places: &mut Places) {
        for run in self.boxes.iter_mut().flat_map(|nodes| &mut nodes.runs) {
            run.place = places.of(run.unknown as usize, run.length as usize);
        }
    }

    /// Writes the values at the points, one number for each component; `scratch` may hold anything.
    pub fn apply(&self, u: Entries, scratch: &mut Vec<f64>, out: &mut [f64]) {
        for (component, nodes) in self.boxes.iter().enumerate() {
            scratch.clear();
            scratch.resize(nodes.length, 0.0);
            for &NodeRun { start, length, place, .. } in &nodes.runs {
                let length = length as usize;
                scratch[start as usize..][..length].copy_from_slice(&u.from(place)[..length]);
            }
            let offsets = row_offsets(nodes.strides);
            vectorized(
                #[inline(always)]
                || {
                    for (point, &corner) in nodes.corners.iter().enumerate() {
                        let weights = self.weights.of(point, nodes.lattice);
                        out[point * self.boxes.len() + component] = interpolated(&scratch[corner as usize..], &offsets, &weights);
                    }
                },
            );
        }
    }
}

/// From the first node of a point to the first of each of its rows along the last axis; only the first `4^(D-1)` are used.
pub fn row_offsets<const D: usize>(strides: [usize; D]) -> [usize; NODES * NODES] {
    std::array::from_fn(|row| (0..D - 1).map(|axis| (row >> (2 * axis)) % NODES * strides[axis]).sum())
}

/// Weights of the rows.
#[inline(always)]
pub fn row_weights<const D: usize>(weights: &[StencilWeights; D]) -> [f64; NODES * NODES] {
    std::array::from_fn(|row| (0..D - 1).map(|axis| weights[axis][(row >> (2 * axis)) % NODES]).product())
}

#[inline(always)]
fn interpolated<const D: usize>(nodes: &[f64], offsets: &[usize; NODES * NODES], weights: &[StencilWeights; D]) -> f64 {
    let mut sums = [0.0; NODES];
    let row_weights = row_weights(weights);
    for (offset, weight) in offsets.iter().zip(row_weights).take(NODES.pow(D as u32 - 1)) {
        let row: &[f64; NODES] = nodes[*offset..].first_chunk().expect("a row of nodes");
        for (sum, value) in sums.iter_mut().zip(row) {
            *sum += weight * value;
        }
    }
    (0..NODES).map(|k| sums[k] * weights[D - 1][k]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::lagrange;

    #[test]
    fn weights_made_anew_are_those_of_lagrange() {
        for part in [-1.0, -0.3, 0.0, 0.25, 0.7, 1.0, 1.9] {
            let (made, wanted) = (cubic_weights(part), lagrange(&[-1.0, 0.0, 1.0, 2.0], part));
            made.iter().zip(wanted).for_each(|(made, wanted)| assert!((made - wanted).abs() < 1e-15, "{part}: {made} {wanted}"));
        }
    }
}
