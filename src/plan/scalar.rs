//! A scalar scene resolved in its dimension.

use nalgebra::SVector;

use super::resolve::suspended_bodies;
use crate::{
    error::Result,
    mechanics::ScalarSetup,
    parallel::Peers,
    scene::{Drive, Scene},
    setup::placement::{bodies, domain},
};

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
}
