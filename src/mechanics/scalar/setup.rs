//! A scalar scene resolved in its dimension.

use std::rc::Rc;

use nalgebra::SVector;

use crate::{
    constraint::{InclusionMethod, Precision, method_of},
    geometry::{Ball, Domain},
    grid::Grid,
    scene::{ConstraintMethod, Tolerance},
    surface::{Modes, ScalarModes},
};

/// What to solve.
#[derive(Debug, Clone)]
pub struct ScalarSetup<const D: usize> {
    /// The box: with walls along at least one axis, or fully periodic with a mean gradient.
    pub domain: Domain<D>,
    /// Spacing asked for.
    pub spacing: f64,
    /// The source `f`.
    pub source: f64,
    /// The mean gradient; only fully periodic boxes have one.
    pub gradient: Option<SVector<f64, D>>,
    /// The inclusions and the highest degree of their modes.
    pub inclusions: Vec<(Ball<D>, usize)>,
    /// How inclusions act on the grid.
    pub constraint: ConstraintMethod,
    /// When it ends.
    pub tolerance: Tolerance,
}

impl<const D: usize> ScalarSetup<D> {
    /// What fills the blocks of the inclusions.
    ///
    /// # Panics
    /// For a fitted mesh, which has no such blocks.
    pub fn method(&self) -> Rc<InclusionMethod<D>> {
        let precision = Precision::for_tolerance(self.tolerance.at_an_instant());
        method_of(self.constraint.word(), self.constraint.epsilon(), precision).expect("a fitted mesh has no blocks on a grid")
    }

    /// Number of multipliers of each inclusion.
    pub fn counts(&self, grid: &Grid<D>) -> Vec<usize> {
        let method = self.method();
        let count = |&(ball, order): &(Ball<D>, usize)| {
            let modes = ScalarModes::<D>::new(ball.radius, order).count();
            method.count(grid, &Ball { center: self.domain.wrap(ball.center), ..ball }, modes)
        };
        self.inclusions.iter().map(count).collect()
    }

    /// Part of the box that inclusions fill.
    pub fn fraction(&self) -> f64 {
        self.inclusions.iter().fold(0.0, |sum, (ball, _)| sum + ball.volume()) / self.domain.volume()
    }
}
