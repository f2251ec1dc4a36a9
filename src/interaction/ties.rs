//! How an interaction ties bodies that it names: in chains, membranes and clusters, by springs and by rows without compliance.

use std::ops::Range;

use nalgebra::SVector;

use super::{Cluster, Conserved, Spring};
use crate::body::Row;

/// Bodies that belong together.
#[derive(Debug, Clone, Copy, Default)]
pub struct Groups<'a, const D: usize> {
    /// Bodies in chains and membranes, one after the other.
    pub chains: &'a [Range<usize>],
    /// Bodies that move as one.
    pub clusters: &'a [Cluster<D>],
    /// For each body the number of the cluster that it is in, from 1 on, or 0; nothing without clusters.
    pub cluster_of: &'a [usize],
    /// What membranes keep, cell by cell.
    pub conserved: &'a [Conserved],
    /// Whether rows of [`welds`](Ties::welds) turn bodies.
    pub turns: bool,
}

/// Ties between bodies, which are named by their numbers.
pub trait Ties<const D: usize> {
    /// Which bodies belong together.
    fn groups(&self) -> Groups<'_, D> {
        Groups::default()
    }

    /// Pairs of bodies that are tied, to be seen in pictures.
    fn bonds(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Coordinates of a few of these bodies that forces oppose in proportion, to be followed implicitly, always in the same order; centres are those of
    /// one image of each body, however far from the box. A tie has its bodies all in the range or none of them.
    fn springs(&self, _bodies: &Range<usize>, _center: &dyn Fn(usize) -> SVector<f64, D>) -> Vec<Spring<D>> {
        Vec::new()
    }

    /// Rows by which bodies with these centres, one for each body of the run, move or turn as one.
    fn welds(&self, _centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        Vec::new()
    }
}
