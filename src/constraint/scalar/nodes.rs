//! Cell centres, and points of walls, around one inclusion.

use nalgebra::{DMatrix, SVector};

use super::PlacedInclusion;
use crate::{
    constraint::patch::Patch,
    grid::{Grid, Index, Node, dirichlet},
};

/// Spacings that stencils and interpolation reach from a surface: next to walls it is one-sided.
const REACH: f64 = 3.0;

/// Jump functions are singular at the centre; closer than this (in spacings) they are taken as zero.
const CORE: f64 = 0.3;

/// Nodes around an inclusion, by their places.
pub struct Nodes<'a, const D: usize> {
    grid: &'a Grid<D>,
    inclusion: &'a PlacedInclusion<D>,
    /// Their indices.
    pub patch: Patch<D>,
    /// Where each is, from the centre of the inclusion.
    pub offsets: Vec<SVector<f64, D>>,
    /// Whether each lies outside it.
    pub outside: Vec<bool>,
}

impl<'a, const D: usize> Nodes<'a, D> {
    /// All that stencils and interpolation may touch.
    pub fn around(grid: &'a Grid<D>, inclusion: &'a PlacedInclusion<D>) -> Self {
        let reach = inclusion.ball.radius + REACH * grid.spacing().max();
        let patch = Patch::of_cells(grid, &inclusion.ball.center, reach);
        let position = |index: Index<D>| SVector::from_fn(|axis, _| dirichlet::coordinate(grid, axis, index[axis]));
        let offsets: Vec<SVector<f64, D>> = patch.indices().map(|index| position(index) - inclusion.ball.center).collect();
        let outside = offsets.iter().map(|offset| inclusion.excludes(offset)).collect();
        Nodes { grid, inclusion, patch, offsets, outside }
    }

    /// The unknown of the node at a place; none on walls, where the scalar is zero.
    pub fn unknown(&self, place: usize) -> Option<u32> {
        let index = self.patch.index(place);
        match dirichlet::within(self.grid, index).then(|| self.grid.node(D, index)) {
            Some(Node::Unknown(unknown)) => Some(unknown as u32),
            _ => None,
        }
    }

    /// Jump functions of an inclusion (rows, the source last) at places (columns).
    pub fn jumps(&self, of: &PlacedInclusion<D>, places: impl Iterator<Item = usize>) -> DMatrix<f64> {
        let shift = self.inclusion.ball.center - of.ball.center;
        let offsets: Vec<SVector<f64, D>> = places.map(|place| self.offsets[place] + shift).collect();
        let mut jumps = of.surface().modes.jumps(&offsets);
        let core = CORE * self.grid.spacing().max();
        for (offset, mut column) in offsets.iter().zip(jumps.column_iter_mut()) {
            if offset.norm() <= core {
                column.fill(0.0);
            }
        }
        jumps
    }

    /// Whether the node at a place lies inside another inclusion.
    pub fn inside(&self, other: &PlacedInclusion<D>, place: usize) -> bool {
        !other.excludes(&(self.offsets[place] + self.inclusion.ball.center - other.ball.center))
    }
}
