//! A scalar scene resolved in its dimension.

use nalgebra::SVector;

use crate::{
    constraint::InclusionMethod,
    error::Result,
    geometry::{Ball, Domain},
    grid::Grid,
    scene::{ConstraintMethod, Drive, MultiplierSolver, Scene, Tolerance},
    simulation::{
        placement::{bodies, domain},
        resolve::suspended_bodies,
    },
    surface::ScalarModes,
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
    pub method: InclusionMethod,
    /// What solves for the multipliers.
    pub solver: MultiplierSolver,
    /// When it ends.
    pub tolerance: Tolerance,
}

impl<const D: usize> ScalarSetup<D> {
    /// Resolves a scene of dimension `D`: places its inclusions and chooses what it leaves open.
    ///
    /// # Errors
    /// Inclusions overlap or lie outside, do not fit at the asked fraction, or are too small for the grid or the modes.
    pub fn of(scene: &Scene) -> Result<ScalarSetup<D>> {
        let domain = domain(scene);
        let (spacing, placed) = suspended_bodies(scene, &domain, bodies(scene, &domain)?)?;
        let inclusions = placed.iter().map(|suspended| (suspended.body.ball, suspended.order)).collect();
        let gradient = match &scene.flow.drive {
            Some(Drive::MeanGradient(gradient)) => Some(SVector::from_column_slice(gradient)),
            _ => None,
        };
        let (method, solver) = method(scene.method.constraint);
        let (source, tolerance) = (scene.flow.source, scene.method.tolerance);
        Ok(ScalarSetup { domain, spacing, source, gradient, inclusions, method, solver, tolerance })
    }

    /// Number of multipliers of each inclusion.
    pub fn counts(&self, grid: &Grid<D>) -> Vec<usize> {
        let count = |&(ball, order): &(Ball<D>, usize)| {
            let modes = ScalarModes::<D>::new(ball.radius, order).count();
            self.method.count(grid, &Ball { center: self.domain.wrap(ball.center), ..ball }, modes)
        };
        self.inclusions.iter().map(count).collect()
    }

    /// Part of the box that inclusions fill.
    pub fn fraction(&self) -> f64 {
        self.inclusions.iter().fold(0.0, |sum, (ball, _)| sum + ball.volume()) / self.domain.volume()
    }
}

/// The method of a scene and what solves for its multipliers.
fn method(constraint: ConstraintMethod) -> (InclusionMethod, MultiplierSolver) {
    match constraint {
        ConstraintMethod::MeanValue(solver) => (InclusionMethod::MeanValue, solver),
        ConstraintMethod::Distributed => (InclusionMethod::Distributed, MultiplierSolver::Krylov),
        ConstraintMethod::Penalty(epsilon) => (InclusionMethod::penalty(epsilon), MultiplierSolver::Krylov),
        // a fitted mesh asks for neither
        ConstraintMethod::Sharp | ConstraintMethod::Fitted => (InclusionMethod::Sharp, MultiplierSolver::Krylov),
    }
}
