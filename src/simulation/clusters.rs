//! Rigid clusters in time: their balls travel as one body, so that the shape stays as it is to rounding however long a run is.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::{State, state::turn};
use crate::{
    body::{Twist, components, planes, skew},
    interaction::Cluster,
};

/// Square of the lever, in radii, at which a force turns a ball in unbounded fluid as its torque does: `8 pi a^3` over `6 pi a`.
const OWN_TURN: f64 = 4.0 / 3.0;

/// Replaces what the balls of clusters are to do in a step by the rigid motion nearest to it: their velocities are those that take them from where they
/// are to where that motion puts them.
pub fn move_as_one<'a, const D: usize>(clusters: impl Iterator<Item = &'a Cluster<D>>, state: &State<D>, moves: &mut [Twist<D>], step: f64) {
    for cluster in clusters {
        let bodies = cluster.bodies.clone();
        let middle = bodies.clone().map(|body| state.bodies[body].center).sum::<SVector<f64, D>>() / bodies.len() as f64;
        let arms: Vec<SVector<f64, D>> = bodies.clone().map(|body| state.bodies[body].center - middle).collect();
        let twist = nearest_rigid(&arms, &moves[bodies.clone()], cluster.radius);
        let turned = turn(&twist.spin, step) * state.bodies[bodies.start].rotation;
        for ((body, offset), arm) in bodies.zip(&cluster.offsets).zip(arms) {
            moves[body] = Twist { velocity: twist.velocity + (turned * offset - arm) / step, spin: twist.spin };
        }
    }
}

/// The rigid motion about the mean of places `arms` away from it that is nearest to the motions of balls there, as the fluid resists them.
fn nearest_rigid<const D: usize>(arms: &[SVector<f64, D>], moves: &[Twist<D>], radius: f64) -> Twist<D> {
    let own = OWN_TURN * radius * radius;
    let units: Vec<SMatrix<f64, D, D>> = (0..planes::<D>().len()).map(unit).collect();
    let resistance = DMatrix::from_fn(units.len(), units.len(), |row, column| {
        let turned = |arm: &SVector<f64, D>| (units[row] * arm).dot(&(units[column] * arm));
        arms.iter().map(turned).sum::<f64>() + if row == column { own * arms.len() as f64 } else { 0.0 }
    });
    let torque = DVector::from_fn(units.len(), |row, _| {
        let of = |(arm, twist): (&SVector<f64, D>, &Twist<D>)| (units[row] * arm).dot(&twist.velocity) + own * components(&twist.spin)[row];
        arms.iter().zip(moves).map(of).sum()
    });
    let spin = resistance.cholesky().expect("the resistance to turning is positive definite").solve(&torque);
    let velocity = moves.iter().map(|twist| twist.velocity).sum::<SVector<f64, D>>() / moves.len() as f64;
    Twist { velocity, spin: skew(spin.as_slice()) }
}

/// A unit rotation about an axis.
fn unit<const D: usize>(axis: usize) -> SMatrix<f64, D, D> {
    let components: Vec<f64> = (0..planes::<D>().len()).map(|other| f64::from(other == axis)).collect();
    skew(&components)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::geometry::Ball;

    #[test]
    fn a_cluster_keeps_its_shape_to_rounding_and_a_rigid_motion_stays_as_it_is() {
        let centers = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.9, 0.3], [0.4, 0.2, -1.1]].map(Vector3::from);
        let balls = centers.map(|center| Ball { center, radius: 0.5 });
        let cluster = Cluster::new(0, &balls);
        let mut state = State::<3>::start(centers.iter().map(|&center| (center, Twist::zero())));
        let (velocity, spin) = (Vector3::new(0.3, -0.2, 0.5), skew(&[0.7, 0.1, -0.4]));
        for _ in 0..1000 {
            let middle = state.centers().iter().sum::<Vector3<f64>>() / 4.0;
            let mut moves: Vec<Twist<3>> =
                state.bodies.iter().map(|body| Twist { velocity: velocity + spin * (body.center - middle), spin }).collect();
            move_as_one(std::iter::once(&cluster), &state, &mut moves, 0.1);
            assert!((moves[0].spin - spin).norm() < 1e-13);
            state.advance(&moves, 0.1);
        }
        for one in 0..4 {
            for other in 0..one {
                let distance = (state.bodies[one].center - state.bodies[other].center).norm();
                assert!((distance - (centers[one] - centers[other]).norm()).abs() < 1e-12);
            }
        }
        let middle = state.centers().iter().sum::<Vector3<f64>>() / 4.0 - centers.iter().sum::<Vector3<f64>>() / 4.0;
        assert!((middle - velocity * 100.0).norm() < 1e-9);
    }
}
