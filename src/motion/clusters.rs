//! Rigid clusters in time: their balls travel as one body, so that the shape stays as it is to rounding however long a run is.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix, SVector};

use crate::{
    body::{Twist, components, planes, skew},
    interaction::Cluster,
    setup::{State, state::turn},
};

/// In radii squared: `8 pi a^3` over `6 pi a`.
const OWN_TURN: f64 = 4.0 / 3.0;

/// Rigid motions of the clusters of a state over a step; balls of their own move as they do.
pub struct ClusterMotions<'a, const D: usize> {
    clusters: Vec<&'a Cluster<D>>,
    state: &'a State<D>,
    step: f64,
    twists: Vec<Twist<D>>,
}

impl<'a, const D: usize> ClusterMotions<'a, D> {
    /// Those nearest to what all balls are to do.
    pub fn nearest(clusters: impl Iterator<Item = &'a Cluster<D>>, state: &'a State<D>, step: f64, moves: &[Twist<D>]) -> Self {
        let clusters: Vec<&Cluster<D>> = clusters.collect();
        let twists =
            clusters.iter().map(|cluster| nearest_rigid(&arms(cluster, state), &moves[cluster.bodies.clone()], cluster.radius)).collect();
        ClusterMotions { clusters, state, step, twists }
    }

    /// Replaces what balls of clusters are to do: their velocities take them from where they are to where the motion of their cluster puts them.
    pub fn carry(&self, moves: &mut [Twist<D>]) {
        for (cluster, twist) in self.clusters.iter().zip(&self.twists) {
            let turned = turn(&twist.spin, self.step) * self.state.bodies[cluster.bodies.start].rotation;
            for ((body, offset), arm) in cluster.bodies.clone().zip(&cluster.offsets).zip(arms(cluster, self.state)) {
                moves[body] = Twist { velocity: twist.velocity + (turned * offset - arm) / self.step, spin: twist.spin };
            }
        }
    }

    /// Adds what brings balls nearer to velocities that differ from what they do by `pushes`: what rigid motions can do of these, as much longer as
    /// these are than that (extrapolated projection, Pierra 1984).
    pub fn follow(&mut self, pushes: &[SVector<f64, D>], moves: &mut [Twist<D>]) {
        let pushed: Vec<Twist<D>> = pushes.iter().map(|push| Twist { velocity: *push, spin: SMatrix::zeros() }).collect();
        let mut possible = pushed.clone();
        let change = ClusterMotions::nearest(self.clusters.iter().copied(), self.state, self.step, &pushed);
        let mut square = 0.0;
        for (cluster, twist) in self.clusters.iter().zip(&change.twists) {
            for (body, arm) in cluster.bodies.clone().zip(arms(cluster, self.state)) {
                possible[body].velocity = twist.at(&arm);
                square += own_turn(cluster.radius) * components(&twist.spin).iter().map(|spin| spin * spin).sum::<f64>();
            }
        }
        square += possible.iter().map(|twist| twist.velocity.norm_squared()).sum::<f64>();
        let length = pushes.iter().map(|push| push.norm_squared()).sum::<f64>() / square.max(f64::MIN_POSITIVE);
        for (twist, change) in self.twists.iter_mut().zip(&change.twists) {
            *twist = Twist { velocity: twist.velocity + change.velocity * length, spin: twist.spin + change.spin * length };
        }
        moves.iter_mut().zip(&possible).for_each(|(twist, push)| twist.velocity += push.velocity * length);
        self.carry(moves);
    }
}

/// Where the balls of a cluster are, from their mean.
fn arms<const D: usize>(cluster: &Cluster<D>, state: &State<D>) -> Vec<SVector<f64, D>> {
    let bodies = &state.bodies[cluster.bodies.clone()];
    let middle = bodies.iter().map(|body| body.center).sum::<SVector<f64, D>>() / bodies.len() as f64;
    bodies.iter().map(|body| body.center - middle).collect()
}

/// Square of the lever at which a force turns a ball in unbounded fluid as its torque does.
fn own_turn(radius: f64) -> f64 {
    OWN_TURN * radius * radius
}

/// The rigid motion about the mean of places `arms` away from it that is nearest to the motions of balls there, as the fluid resists them.
fn nearest_rigid<const D: usize>(arms: &[SVector<f64, D>], moves: &[Twist<D>], radius: f64) -> Twist<D> {
    let own = own_turn(radius);
    let velocities: Vec<SVector<f64, D>> = moves.iter().map(|twist| twist.velocity).collect();
    let spins: SMatrix<f64, D, D> = moves.iter().map(|twist| twist.spin).sum();
    let spin = spin_of(arms, own, &(moment(arms, &velocities) + spins * own));
    Twist { velocity: velocities.iter().sum::<SVector<f64, D>>() / moves.len() as f64, spin }
}

/// The angular momentum about their mean of unit masses at `arms` with these velocities, a skew matrix.
pub(super) fn moment<const D: usize>(arms: &[SVector<f64, D>], velocities: &[SVector<f64, D>]) -> SMatrix<f64, D, D> {
    arms.iter().zip(velocities).map(|(arm, velocity)| velocity * arm.transpose() - arm * velocity.transpose()).sum()
}

/// The spin at which balls of unit mass and moment of inertia `own`, at `arms` from their mean, have an angular momentum together.
pub(super) fn spin_of<const D: usize>(arms: &[SVector<f64, D>], own: f64, momentum: &SMatrix<f64, D, D>) -> SMatrix<f64, D, D> {
    let momentum = DVector::from_vec(components(momentum));
    skew(inertia(arms, own).solve(&momentum).as_slice())
}

/// The factor of the moments of inertia of the same balls together.
pub(super) fn inertia<const D: usize>(arms: &[SVector<f64, D>], own: f64) -> Cholesky<f64, Dyn> {
    let units: Vec<SMatrix<f64, D, D>> = (0..planes::<D>().len()).map(unit).collect();
    let inertia = DMatrix::from_fn(units.len(), units.len(), |row, column| {
        let turned = |arm: &SVector<f64, D>| (units[row] * arm).dot(&(units[column] * arm));
        arms.iter().map(turned).sum::<f64>() + if row == column { own * arms.len() as f64 } else { 0.0 }
    });
    inertia.cholesky().expect("an inertia is positive definite")
}

/// A unit rotation about an axis.
pub(super) fn unit<const D: usize>(axis: usize) -> SMatrix<f64, D, D> {
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
            ClusterMotions::nearest(std::iter::once(&cluster), &state, 0.1, &moves).carry(&mut moves);
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
