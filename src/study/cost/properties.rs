//! What a study has to know of a scene, whatever its dimension: box, bodies, modes.

use crate::{
    error::Result,
    geometry::Domain,
    mechanics::ScalarSetup,
    scene::{BodyGroup, FlowModel, Scene},
    setup::Setup,
};

/// Box and bodies of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneProperties {
    /// Dimension of space.
    pub dimension: usize,
    /// Radius of the smallest body.
    pub radius: Option<f64>,
    /// Whether each body's motion is given.
    pub held: Vec<bool>,
    /// Highest order of the modes of any body.
    pub modes: Option<usize>,
    /// Length of the box along each periodic axis.
    pub periods: Vec<Option<f64>>,
    /// Volume of the box.
    pub volume: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Whether the flow has inertia.
    pub inertia: bool,
    /// Whether such a flow passes bodies that all stay where they are, so that it may become steady.
    pub steady: bool,
}

impl SceneProperties {
    /// Those of a scene.
    ///
    /// # Errors
    /// Its bodies cannot be placed, or the modes do not suit the grid.
    pub fn of(scene: &Scene) -> Result<SceneProperties> {
        match scene.dimension() {
            2 => SceneProperties::in_dimension::<2>(scene),
            _ => SceneProperties::in_dimension::<3>(scene),
        }
    }

    fn in_dimension<const D: usize>(scene: &Scene) -> Result<SceneProperties> {
        let (domain, bodies): (Domain<D>, Vec<(f64, bool, usize)>) = if scene.scalar() {
            let setup = ScalarSetup::of(scene)?;
            (setup.domain, setup.inclusions.iter().map(|(ball, order)| (ball.radius, false, *order)).collect())
        } else {
            let setup = Setup::of(scene)?;
            (setup.domain, setup.bodies.iter().map(|own| (own.body.ball.radius, !own.body.free(), own.order)).collect())
        };
        let inertia = scene.flow.model == FlowModel::NavierStokes;
        Ok(SceneProperties {
            dimension: D,
            radius: bodies.iter().map(|(radius, ..)| *radius).reduce(f64::min),
            held: bodies.iter().map(|(_, held, _)| *held).collect(),
            modes: bodies.iter().map(|(.., order)| *order).max(),
            periods: (0..D).map(|axis| domain.periodic(axis).then(|| domain.size[axis])).collect(),
            volume: domain.volume(),
            viscosity: scene.flow.viscosity,
            inertia,
            steady: inertia && !scene.bodies.is_empty() && scene.bodies.iter().all(BodyGroup::stays),
        })
    }

    /// Whether no body is free.
    pub fn all_held(&self) -> bool {
        !self.held.is_empty() && self.held.iter().all(|held| *held)
    }

    /// Radius of the smallest body, or 1 where spacings are lengths anyway.
    pub fn unit(&self) -> f64 {
        self.radius.unwrap_or(1.0)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub mod tests {
    use std::path::Path;

    use super::*;

    const DISK: &str = "domain.size = [4, 4]\nresolution.spacing = 0.125\n[[bodies]]\nradius = 0.5\ncenters = [[1, 1]]\n";

    impl Default for SceneProperties {
        fn default() -> SceneProperties {
            let (radius, held, periods) = (Some(1.0), vec![true], vec![None; 2]);
            SceneProperties { dimension: 2, radius, held, modes: None, periods, volume: 1.0, viscosity: 1.0, inertia: false, steady: false }
        }
    }

    /// The scene of a disk with something more, and what is known of it.
    pub fn suits(extra: &str) -> (Scene, SceneProperties) {
        let scene = Scene::parse("scene", Path::new(""), &(DISK.to_owned() + extra), &[]).unwrap();
        let properties = SceneProperties::of(&scene).unwrap();
        (scene, properties)
    }
}
