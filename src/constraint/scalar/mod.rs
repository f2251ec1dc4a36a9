//! Inclusions in which a scalar is constant, by one of several methods that fill the same blocks.
//!
//! With `A` minus the Laplacian at cell centres, which no inclusion changes, and the multipliers `c`,
//!
//! ```text
//! A u - C c = f (chi + s)      C: where the multipliers act,   s: what confines the source,  chi = 1 outside inclusions
//! J u + E c + f e = values     J: where the scalar is tested,  E, e: what is known beside the grid
//! ```
//!
//! and the values are those of an unknown constant on each inclusion, out of which nothing flows net. A method is a file that
//! assembles [`InclusionBlocks`]: who solves with them does not know which one it was.

mod blocks;
mod cells;
mod coupling;
mod distributed;
mod envelope;
mod links;
mod mean_value;
mod nodes;
mod penalty;
mod sharp;

use std::{fmt, rc::Rc};

use nalgebra::SVector;

use crate::{constraint::Layout, geometry::Ball, grid::Grid, surface::ScalarSurface};
pub use blocks::{InclusionBlocks, ScalarBlocks};

/// How inclusions act on the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InclusionMethod {
    /// Modes on surfaces, with stencils corrected for the jump of the slope.
    Sharp,
    /// Modes on surfaces, with linear interpolation.
    MeanValue,
    /// Sources in all cells whose centres lie inside.
    Distributed,
    /// A conductivity inside.
    Penalty {
        /// One over it.
        epsilon: f64,
    },
}

impl fmt::Display for InclusionMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InclusionMethod::Sharp => write!(f, "with surface multipliers and corrected stencils (sharp)"),
            InclusionMethod::MeanValue => write!(f, "with surface multipliers and linear interpolation (mean-value)"),
            InclusionMethod::Distributed => write!(f, "with a multiplier in each cell inside (distributed)"),
            InclusionMethod::Penalty { epsilon } => write!(f, "that conduct 1/{epsilon:e}, with Cholesky factors of each (penalty)"),
        }
    }
}

/// An inclusion in its place.
#[derive(Clone)]
pub struct PlacedInclusion<const D: usize> {
    /// Where it is, in the box or, for an image, beyond it.
    pub ball: Ball<D>,
    /// Its surface, if the method has multipliers there.
    pub surface: Option<Rc<ScalarSurface<D>>>,
}

impl<const D: usize> PlacedInclusion<D> {
    /// Whether a point at an offset from the centre lies outside.
    fn excludes(&self, offset: &SVector<f64, D>) -> bool {
        offset.norm_squared() > self.ball.radius.powi(2)
    }

    fn surface(&self) -> &ScalarSurface<D> {
        self.surface.as_ref().expect("inclusions of a method on surfaces have one")
    }
}

impl InclusionMethod {
    /// The penalty method with its own choice of epsilon unless one is given.
    pub fn penalty(epsilon: Option<f64>) -> InclusionMethod {
        InclusionMethod::Penalty { epsilon: epsilon.unwrap_or(penalty::EPSILON) }
    }

    /// Whether its multipliers are modes on surfaces.
    pub fn on_surfaces(self) -> bool {
        matches!(self, InclusionMethod::Sharp | InclusionMethod::MeanValue)
    }

    /// Number of multipliers of an inclusion in its place, with so many modes on its surface.
    pub fn count<const D: usize>(self, grid: &Grid<D>, ball: &Ball<D>, modes: usize) -> usize {
        match self {
            InclusionMethod::Sharp | InclusionMethod::MeanValue => modes,
            InclusionMethod::Distributed => distributed::count(grid, ball),
            InclusionMethod::Penalty { .. } => penalty::count(grid, ball),
        }
    }

    /// Bytes that the blocks of an inclusion with so many multipliers in space of dimension `D` take, about.
    pub fn bytes<const D: usize>(self, count: usize) -> f64 {
        let count = count as f64;
        match self {
            // rows, and blocks of it and of about four neighbours
            InclusionMethod::Sharp | InclusionMethod::MeanValue => 8.0 * 10.0 * count * count,
            InclusionMethod::Distributed => 32.0 * D as f64 * count,
            // a row of the factors spans a slice of the inclusion
            InclusionMethod::Penalty { .. } => 8.0 * count.powf(2.0 - 1.0 / D as f64),
        }
    }

    /// The blocks of an inclusion, from it and the neighbours, with their numbers, that its interpolation may meet.
    pub fn assemble<const D: usize>(
        self,
        grid: &Grid<D>,
        layout: &Layout,
        (body, inclusion): (usize, &PlacedInclusion<D>),
        neighbours: &[(usize, PlacedInclusion<D>)],
    ) -> InclusionBlocks {
        match self {
            InclusionMethod::Sharp => sharp::assemble(grid, layout, (body, inclusion), neighbours),
            InclusionMethod::MeanValue => mean_value::assemble(grid, layout, (body, inclusion)),
            InclusionMethod::Distributed => distributed::assemble(grid, layout, (body, &inclusion.ball)),
            InclusionMethod::Penalty { epsilon } => penalty::assemble(grid, layout, (body, &inclusion.ball), epsilon),
        }
    }
}
