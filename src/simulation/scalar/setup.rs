//! A scalar scene resolved in its dimension.

use crate::{
    error::Result,
    geometry::{Ball, Domain},
    scene::{Scene, Tolerance},
    simulation::{
        placement::{bodies, domain},
        setup::suspended_bodies,
    },
    surface::ScalarModes,
};

/// What to solve.
#[derive(Debug, Clone)]
pub struct ScalarSetup<const D: usize> {
    /// The box, with walls along at least one axis.
    pub domain: Domain<D>,
    /// Spacing asked for.
    pub spacing: f64,
    /// The source `f`.
    pub source: f64,
    /// The inclusions and the highest degree of their modes.
    pub inclusions: Vec<(Ball<D>, usize)>,
    /// When the linear solver ends.
    pub tolerance: Tolerance,
}

impl<const D: usize> ScalarSetup<D> {
    /// Resolves a scene of dimension `D`: places its inclusions and chooses what it leaves open.
    ///
    /// # Errors
    /// Inclusions overlap or lie outside, do not fit at the asked fraction, or are too small for the grid or the modes.
    pub fn of(scene: &Scene) -> Result<ScalarSetup<D>> {
        let domain = domain(scene);
        let (spacing, placed) = suspended_bodies(scene, bodies(scene, &domain)?)?;
        let inclusions = placed.iter().map(|suspended| (suspended.body.ball, suspended.order)).collect();
        Ok(ScalarSetup { domain, spacing, source: scene.flow.source, inclusions, tolerance: scene.method.tolerance })
    }

    /// Number of multipliers of all inclusions.
    pub fn multipliers(&self) -> usize {
        self.inclusions.iter().map(|&(ball, order)| ScalarModes::<D>::new(ball.radius, order).count()).sum()
    }

    /// Part of the box that inclusions fill.
    pub fn fraction(&self) -> f64 {
        self.inclusions.iter().fold(0.0, |sum, (ball, _)| sum + ball.volume()) / self.domain.volume()
    }
}
