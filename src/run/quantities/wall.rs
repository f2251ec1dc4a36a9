//! A wall that a pressure moves along its normal, and the layer of bodies below it.

use nalgebra::SVector;

use crate::{
    geometry::Ball,
    run::{quantity::Quantity, view::View},
};

/// Where the wall is, how dense the layer, and what its contacts do to the wall.
pub fn loaded<const D: usize>() -> Vec<Quantity<D>> {
    let stress = "force of the contacts of the step on the wall that domain.normal_stress presses, and on what is fixed to it, per area, in the axes of the box";
    let ratio = "magnitude of loaded_wall_stress along the wall over domain.normal_stress, the friction coefficient of the layer: never negative, so that its \
                 mean is that of magnitudes; the sign is that of loaded_wall_stress";
    vec![
        Quantity::new("wall_position", "length", "coordinate of the wall that domain.normal_stress presses", |view| {
            Some(view.motion?.state().wall?.position)
        }),
        Quantity::new(
            "solid_fraction",
            "ratio",
            "volume of all bodies over that between the walls, of which the pressed one moves",
            solid_fraction,
        ),
        Quantity::new("loaded_wall_stress", "pressure", stress, wall_stress),
        Quantity::new("stress_ratio", "ratio", ratio, |view| {
            let (axis, mut stress): (usize, SVector<f64, D>) = (view.motion?.state().wall?.axis, wall_stress(view)?);
            stress[axis] = 0.0;
            Some(stress.norm() / view.scene.domain.load?.stress)
        }),
    ]
}

/// The volume of the bodies over that of the box under a loaded wall. Collective.
fn solid_fraction<const D: usize>(view: &View<D>) -> Option<f64> {
    let motion = view.motion.filter(|motion| motion.state().wall.is_some())?;
    let volume = |radius: &f64| Ball::<D> { center: SVector::zeros(), radius: *radius }.volume();
    let mut sum = [motion.simulation.radii().iter().map(volume).sum()];
    motion.state().peers(view.world).sum(&mut sum);
    Some(sum[0] / motion.domain().volume())
}

fn wall_stress<const D: usize>(view: &View<D>) -> Option<SVector<f64, D>> {
    let motion = view.motion?;
    let (wall, domain) = (motion.state().wall?, motion.domain());
    Some(wall.force * (domain.size[wall.axis] / domain.volume()))
}
