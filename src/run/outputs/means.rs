//! Columns of `series.csv` that say how bodies and fluid move in the mean, and the mean stress.

use nalgebra::{SMatrix, SVector};

use super::cell::{Cell, real};
use crate::{
    flow::Drive,
    observe::Viscosity,
    parallel::World,
    run::{Evaluated, EvaluatedMotion},
};

const BODY_VELOCITY: [&str; 3] = ["body_velocity_x", "body_velocity_y", "body_velocity_z"];
const MEAN_VELOCITY: [&str; 3] = ["mean_velocity_x", "mean_velocity_y", "mean_velocity_z"];
const FLOW_RATE: [&str; 3] = ["flow_rate_x", "flow_rate_y", "flow_rate_z"];
const STRESS: [&str; 6] = ["stress_xx", "stress_xy", "stress_xz", "stress_yy", "stress_yz", "stress_zz"];

/// The mean velocity of the free bodies, their kinetic energy if they alone have inertia, and the mean velocity of the flow with its rate along
/// axes without walls, unless the flow is a shear. Collective.
pub fn mean_motion<const D: usize>(seen: &Evaluated<D>, motion: &EvaluatedMotion<D>) -> Vec<Cell> {
    let mut cells = Vec::new();
    if let Some(mean) = body_velocity(seen.world, motion) {
        cells.extend((0..D).map(|axis| real(BODY_VELOCITY[axis], mean[axis])));
    }
    if let Some(energy) = motion.observation.kinetic_energy {
        let mut sum = [energy];
        motion.state().peers(seen.world).sum(&mut sum);
        cells.push(real("kinetic_energy", sum[0]));
    }
    let Some(flow) = seen.flow.filter(|flow| !matches!(flow.solver.setup().drive, Drive::Shear(_))) else { return cells };
    let (domain, mean) = (motion.domain(), flow.solution.mean_velocity);
    for axis in (0..D).filter(|&axis| domain.axes[axis].walls().is_none() || domain.open().is_some_and(|(open, _)| open == axis)) {
        let section = domain.volume() / domain.size[axis];
        cells.extend([real(MEAN_VELOCITY[axis], mean[axis]), real(FLOW_RATE[axis], mean[axis] * section)]);
    }
    cells
}

/// The mean over free bodies of the velocity of the image in the box; nothing without any. Collective.
fn body_velocity<const D: usize>(world: &World, motion: &EvaluatedMotion<D>) -> Option<SVector<f64, D>> {
    let (state, domain) = (motion.state(), motion.domain());
    let mut sums = vec![0.0; D + 1];
    let bodies = state.bodies.iter().zip(&motion.observation.twists).zip(motion.simulation.free());
    for ((body, twist), _) in bodies.filter(|(_, free)| *free) {
        let velocity = twist.velocity - domain.image_velocity(&body.center);
        (0..D).for_each(|axis| sums[axis] += velocity[axis]);
        sums[D] += 1.0;
    }
    state.peers(world).sum(&mut sums);
    (sums[D] > 0.0).then(|| SVector::from_fn(|axis, _| sums[axis] / sums[D]))
}

/// The mean stress over viscosity and rate.
pub fn of_stress<const D: usize>(viscosity: &Viscosity) -> Vec<Cell> {
    let stress: SMatrix<f64, D, D> = viscosity.stress.fixed_view::<D, D>(0, 0).into_owned();
    upper_triangle(&STRESS, &stress).map(|(name, value)| real(name, value)).collect()
}

/// The entries of a symmetric matrix with the names of those in space.
pub fn upper_triangle<const D: usize>(names: &[&'static str; 6], matrix: &SMatrix<f64, D, D>) -> impl Iterator<Item = (&'static str, f64)> {
    let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().zip(*names).filter(|((_, column), _)| *column < D);
    places.map(|(place, name)| (name, matrix[place]))
}
