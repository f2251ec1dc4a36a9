//! The picture of a solution: the flow in the plane of the first two axes, through the middle of the box.

use nalgebra::SVector;

use super::velocities;
use crate::{
    error::Result,
    output::{Disk, Picture},
    simulation::{FlowSolver, Solution},
};

/// Most samples along the longer side.
const SAMPLES: f64 = 420.0;

/// Most samples a cell: more show nothing new, and in 3D each takes 192 nodes.
const SAMPLES_PER_CELL: f64 = 4.0;

/// Cuts a solution; collective, and the same on every rank.
pub fn picture<const D: usize>(title: &str, suspension: &dyn FlowSolver<D>, solution: &Solution<D>) -> Result<Picture> {
    let (setup, domain) = (suspension.setup(), &suspension.setup().domain);
    let size = [domain.size[0], domain.size[1]];
    let density = (SAMPLES / size[0].max(size[1])).min(SAMPLES_PER_CELL / suspension.grid().spacing().min());
    let samples = size.map(|length| (density * length).ceil().max(8.0) as usize);
    let middle = domain.size * 0.5;
    let points: Vec<SVector<f64, D>> = (0..samples[0] * samples[1])
        .map(|place| {
            let mut point = middle;
            for (axis, index) in [place % samples[0], place / samples[0]].into_iter().enumerate() {
                point[axis] = (index as f64 + 0.5) * size[axis] / samples[axis] as f64;
            }
            point
        })
        .collect();
    let disturbance = velocities(suspension.grid(), &solution.fluid, &points)?;
    let total: Vec<SVector<f64, D>> =
        points.iter().zip(disturbance).map(|(point, velocity)| velocity + setup.drive.background(point)).collect();
    Ok(Picture {
        title: title.to_owned(),
        size,
        periodic: [domain.periodic(0), domain.periodic(1)],
        bodies: disks(suspension, solution),
        samples,
        velocity: total.iter().map(|velocity| [velocity[0], velocity[1]]).collect(),
        speed: total.iter().map(|velocity| velocity.norm()).collect(),
    })
}

/// The cuts of the bodies through the plane, periodic images included where they reach it.
fn disks<const D: usize>(suspension: &dyn FlowSolver<D>, solution: &Solution<D>) -> Vec<Disk> {
    let domain = &suspension.setup().domain;
    let bodies = suspension.setup().bodies.iter().zip(&solution.bodies);
    bodies
        .filter_map(|(suspended, state)| {
            let ball = suspended.body.ball;
            let center = state.center;
            let from_plane = domain.nearest_image(center - domain.size * 0.5);
            let height: f64 = from_plane.iter().skip(2).map(|offset| offset * offset).sum();
            let squared = ball.radius * ball.radius - height;
            (squared > 0.0).then(|| Disk {
                center: [center[0], center[1]],
                radius: squared.sqrt(),
                velocity: [state.twist.velocity[0], state.twist.velocity[1]],
            })
        })
        .collect()
}
