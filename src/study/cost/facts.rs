//! What a study has to know of a scene, whatever its dimension: box, bodies, modes.

use crate::{
    error::Result,
    geometry::Domain,
    scene::Scene,
    simulation::{ScalarSetup, Setup},
};

/// Box and bodies of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Dimension of space.
    pub dimension: usize,
    /// Radius of the smallest body.
    pub radius: Option<f64>,
    /// Whether each body's motion is given.
    pub held: Vec<bool>,
    /// Length of the box along each periodic axis.
    pub periods: Vec<Option<f64>>,
    /// Number of bodies.
    pub bodies: usize,
    /// Volume of the box.
    pub volume: f64,
}

/// Highest order of the modes of any body of a scene.
///
/// # Errors
/// They do not suit the grid, or the bodies cannot be placed.
pub fn modes(scene: &Scene) -> Result<Option<usize>> {
    let orders: Vec<usize> = match (scene.scalar(), scene.dimension()) {
        (true, 2) => ScalarSetup::<2>::of(scene)?.inclusions.iter().map(|inclusion| inclusion.1).collect(),
        (true, _) => ScalarSetup::<3>::of(scene)?.inclusions.iter().map(|inclusion| inclusion.1).collect(),
        (false, 2) => Setup::<2>::of(scene)?.bodies.iter().map(|body| body.order).collect(),
        (false, _) => Setup::<3>::of(scene)?.bodies.iter().map(|body| body.order).collect(),
    };
    Ok(orders.into_iter().max())
}

impl Facts {
    /// Those of a scene.
    ///
    /// # Errors
    /// Its bodies cannot be placed.
    pub fn of(scene: &Scene) -> Result<Facts> {
        match scene.dimension() {
            2 => Facts::in_dimension::<2>(scene),
            _ => Facts::in_dimension::<3>(scene),
        }
    }

    fn in_dimension<const D: usize>(scene: &Scene) -> Result<Facts> {
        if scene.scalar() {
            let setup = ScalarSetup::<D>::of(scene)?;
            return Ok(Facts::with(&setup.domain, setup.inclusions.iter().map(|(ball, _)| (ball.radius, false))));
        }
        let setup = Setup::<D>::of(scene)?;
        Ok(Facts::with(&setup.domain, setup.bodies.iter().map(|suspended| (suspended.body.ball.radius, !suspended.body.free()))))
    }

    /// Radius of the smallest body, or 1 where spacings are lengths anyway.
    pub fn unit(&self) -> f64 {
        self.radius.unwrap_or(1.0)
    }

    fn with<const D: usize>(domain: &Domain<D>, bodies: impl Iterator<Item = (f64, bool)>) -> Facts {
        let (radii, held): (Vec<f64>, Vec<bool>) = bodies.unzip();
        Facts {
            dimension: D,
            radius: radii.iter().copied().reduce(f64::min),
            bodies: held.len(),
            held,
            periods: (0..D).map(|axis| domain.periodic(axis).then(|| domain.size[axis])).collect(),
            volume: domain.volume(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub mod tests {
    use std::path::Path;

    use super::*;

    const DISK: &str = "domain.size = [4, 4]\nresolution.spacing = 0.125\n[[bodies]]\nradius = 0.5\ncenters = [[1, 1]]\n";

    /// The scene of a disk with something more, and what is known of it.
    pub fn suits(extra: &str) -> (Scene, Facts) {
        let scene = Scene::parse("scene", Path::new(""), &(DISK.to_owned() + extra), &[]).unwrap();
        let facts = Facts::of(&scene).unwrap();
        (scene, facts)
    }
}
