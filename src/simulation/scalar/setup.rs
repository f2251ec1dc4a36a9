//! A scalar scene resolved in its dimension.

use std::rc::Rc;

use nalgebra::SVector;

use crate::{
    constraint::{InclusionMethod, Precision, method_of},
    error::Result,
    geometry::{Ball, Domain},
    grid::Grid,
    parallel::Peers,
    scene::{ConstraintMethod, Drive, Scene, Tolerance},
    simulation::{
        placement::{bodies, domain},
        resolve::suspended_bodies,
    },
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
    /// Resolves a scene of dimension `D`: places its inclusions and chooses what it leaves open.
    ///
    /// # Errors
    /// Inclusions overlap or lie outside, do not fit at the asked fraction, or are too small for the grid or the modes.
    pub fn of(scene: &Scene) -> Result<ScalarSetup<D>> {
        Self::on(Peers::Alone, scene)
    }

    /// The same by ranks that place many bodies together; collective.
    ///
    /// # Errors
    /// The same.
    pub fn on(peers: Peers, scene: &Scene) -> Result<ScalarSetup<D>> {
        let domain = domain(scene);
        let (spacing, placed) = suspended_bodies(scene, &domain, bodies(peers, scene, &domain)?)?;
        let inclusions = placed.iter().map(|suspended| (suspended.body.ball, suspended.order)).collect();
        let gradient = match &scene.flow.drive {
            Some(Drive::MeanGradient(gradient)) => Some(SVector::from_column_slice(gradient)),
            _ => None,
        };
        let (source, constraint, tolerance) = (scene.flow.source, scene.method.constraint, scene.method.tolerance);
        Ok(ScalarSetup { domain, spacing, source, gradient, inclusions, constraint, tolerance })
    }

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
