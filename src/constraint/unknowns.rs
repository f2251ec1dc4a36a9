//! The unknowns of the grid that bodies act on: those of a fluid, or a scalar.

use crate::{
    grid::{Grid, Index, Node, dirichlet},
    surface::Modes,
};

/// The unknowns of a problem; its fields are numbered from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknowns {
    /// Components of the velocity, then the pressure, in fluid vectors.
    Fluid,
    /// A scalar at cell centres that is zero on walls.
    Scalar,
}

impl Unknowns {
    /// Those that multipliers of these modes act on.
    pub fn of(modes: &dyn Modes) -> Unknowns {
        if modes.components() == 1 { Unknowns::Scalar } else { Unknowns::Fluid }
    }

    /// Number of fields on whose values bodies put conditions; a pressure comes behind them.
    pub fn components<const D: usize>(self) -> usize {
        match self {
            Unknowns::Fluid => D,
            Unknowns::Scalar => 1,
        }
    }

    /// Number of fields.
    pub fn fields<const D: usize>(self) -> usize {
        match self {
            Unknowns::Fluid => D + 1,
            Unknowns::Scalar => 1,
        }
    }

    /// The lattice on which a field lies.
    pub fn lattice<const D: usize>(self, field: usize) -> usize {
        match self {
            Unknowns::Fluid => field,
            Unknowns::Scalar => D,
        }
    }

    /// The unknown at an index of a field; nothing on a wall, where the value is known.
    pub fn at<const D: usize>(self, grid: &Grid<D>, field: usize, index: Index<D>) -> Option<usize> {
        match self {
            Unknowns::Scalar if !dirichlet::within(grid, index) => None,
            _ => self.run(grid, field, index).0,
        }
    }

    /// As [`at`](Self::at), for an index of the lattice, with the number of nodes, it included, that follow each other along the last axis
    /// and in vectors.
    pub fn run<const D: usize>(self, grid: &Grid<D>, field: usize, index: Index<D>) -> (Option<usize>, usize) {
        let (node, length) = match self {
            Unknowns::Fluid => grid.fluid_run(field, index),
            Unknowns::Scalar => grid.run(D, index),
        };
        match node {
            Node::Unknown(unknown) => (Some(unknown), length),
            Node::Wall(_) => (None, length),
        }
    }
}
