//! Mean velocities of bodies and flow.

use nalgebra::SVector;

use super::inertia::KINETIC_ENERGY;
use crate::{
    flow::Drive,
    output::AXES,
    run::{quantity::Quantity, view::View},
};

/// The mean velocity of the free bodies, their kinetic energy if they alone have inertia, and the mean velocity of the flow with its rate along
/// axes without walls, unless the flow is a shear.
pub fn velocities<const D: usize>() -> Vec<Quantity<D>> {
    let (unit, meaning) = KINETIC_ENERGY;
    let of_bodies = [
        Quantity::new(
            "body_velocity",
            "length/time",
            "mean velocity of the free bodies; beads of chains and balls of clusters count one by one",
            body_velocity,
        ),
        Quantity::new("kinetic_energy", unit, meaning, |view| {
            let mut sum = [view.motion?.observation.kinetic_energy?];
            view.motion?.state().peers(view.world).sum(&mut sum);
            Some(sum[0])
        }),
    ];
    let gradient = Quantity::new(
        "pressure_gradient",
        "pressure/length",
        "where the mean velocity is prescribed: mean pressure gradient that drives it",
        |view| {
            let flow = view.flow.filter(|flow| matches!(flow.solver.setup().drive, Drive::MeanVelocity(_)))?;
            view.motion.map(|_| flow.solution.pressure_gradient)
        },
    );
    of_bodies.into_iter().chain((0..D).flat_map(velocities_along)).chain([gradient]).collect()
}

/// What flows along an axis.
fn velocities_along<const D: usize>(axis: usize) -> [Quantity<D>; 2] {
    let (name, mean) = (AXES[axis], "along axes without walls: mean velocity over the whole box, bodies included");
    [
        Quantity::new(format!("mean_velocity_{name}"), "length/time", mean, move |view| mean_velocity(view, axis)),
        Quantity::new(
            format!("flow_rate_{name}"),
            "volume/time; 2D: area/time",
            "along axes without walls: mean velocity times the cross-section of the box",
            move |view| {
                let domain = view.motion?.domain();
                let section = domain.volume() / domain.size[axis];
                Some(mean_velocity(view, axis)? * section)
            },
        ),
    ]
}

/// The mean over free bodies of the velocity of the image in the box; nothing without any. Collective.
fn body_velocity<const D: usize>(view: &View<D>) -> Option<SVector<f64, D>> {
    let motion = view.motion?;
    let (state, domain) = (motion.state(), motion.domain());
    let mut sums = vec![0.0; D + 1];
    let bodies = state.bodies.iter().zip(&motion.observation.twists).zip(motion.simulation.free());
    for ((body, twist), _) in bodies.filter(|(_, free)| *free) {
        let velocity = twist.velocity - domain.image_velocity(&body.center);
        (0..D).for_each(|axis| sums[axis] += velocity[axis]);
        sums[D] += 1.0;
    }
    state.peers(view.world).sum(&mut sums);
    (sums[D] > 0.0).then(|| SVector::from_fn(|axis, _| sums[axis] / sums[D]))
}

/// The mean velocity of a flow that is no background shear, along an axis without walls.
fn mean_velocity<const D: usize>(view: &View<D>, axis: usize) -> Option<f64> {
    let (flow, domain) = (view.flow?, view.motion?.domain());
    let through = domain.axes[axis].ends().is_none() || domain.open().is_some_and(|(open, _)| open == axis);
    (through && !matches!(flow.solver.setup().drive, Drive::Shear(_))).then(|| flow.solution.mean_velocity[axis])
}
