//! Rigid clusters of dry bodies: the balls of each move over a step as one body that has their momentum and their angular momentum.
//!
//! The motion of a cluster is the nearest to those of its balls, weighed by masses and moments of inertia. It turns by the spin that its angular momentum
//! has half way through the step, and the angular momentum is kept from step to step, so that a free body turns as Euler's equations say, to second order.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::{
    State,
    clusters::{moment, spin_of},
    state::turn,
};
use crate::{
    body::{Halo, Twist},
    interaction::Cluster,
    parallel::Peers,
};

/// Corrections of the spin half way: one makes it of second order.
const CORRECTIONS: usize = 3;

/// The clusters with balls of this rank, in a step.
pub struct GranularClusters<const D: usize> {
    halo: Halo,
    clusters: Vec<RigidCluster<D>>,
    step: f64,
}

/// A cluster; masses are in those of its balls.
struct RigidCluster<const D: usize> {
    /// Places of its balls in the halo.
    balls: Range<usize>,
    /// Where they are, from their mean.
    arms: Vec<SVector<f64, D>>,
    /// Where they would be if it had not turned.
    offsets: Vec<SVector<f64, D>>,
    /// How it has turned.
    rotation: SMatrix<f64, D, D>,
    /// Moment of inertia of each ball.
    own: f64,
    /// Angular momentum of its balls about their own centres.
    own_momentum: SMatrix<f64, D, D>,
}

/// What a cluster does over a step.
struct RigidMotion<const D: usize> {
    velocity: SVector<f64, D>,
    /// Its spin over the step, and at the end.
    spins: [SMatrix<f64, D, D>; 2],
    /// Where its balls are then, from their mean.
    arms: Vec<SVector<f64, D>>,
}

impl<const D: usize> GranularClusters<D> {
    /// Those of these clusters, the own bodies having these moments of inertia over masses, and these spins without clusters. Collective.
    pub fn new(
        peers: Peers,
        clusters: &[Cluster<D>],
        (state, own): (&State<D>, &[f64]),
        moves: &[Twist<D>],
        step: f64,
    ) -> GranularClusters<D> {
        let numbers = state.numbers();
        let owns = |cluster: &&Cluster<D>| {
            let next = numbers.get(numbers.partition_point(|&number| number < cluster.bodies.start));
            next.is_some_and(|&next| next < cluster.bodies.end)
        };
        let seen: Vec<&Cluster<D>> = clusters.iter().filter(owns).collect();
        let halo = Halo::of_numbers(peers, &numbers, seen.iter().flat_map(|cluster| cluster.bodies.clone()));
        let centers = halo.spread_vectors(peers, &state.centers());
        let rotations = spread_matrices(peers, &halo, state.bodies.iter().map(|body| body.rotation));
        let spins = spread_matrices(peers, &halo, moves.iter().map(|twist| twist.spin));
        let own = halo.spread(peers, own);
        let rigid = |cluster: &&Cluster<D>| {
            let first = halo.place(cluster.bodies.start).unwrap_or_default();
            let balls = first..first + cluster.bodies.len();
            RigidCluster {
                arms: from_mean(&centers[balls.clone()]),
                offsets: cluster.offsets.clone(),
                rotation: rotations[first],
                own: own[first],
                own_momentum: spins[balls.clone()].iter().sum::<SMatrix<f64, D, D>>() * own[first],
                balls,
            }
        };
        GranularClusters { clusters: seen.iter().map(rigid).collect(), halo, step }
    }

    /// The velocities that carry the own bodies over the step as rigid motions do, next to wanted ones. Collective.
    pub fn hold(&self, peers: Peers, wanted: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let mut velocities = self.halo.spread_vectors(peers, wanted);
        for cluster in &self.clusters {
            let motion = cluster.motion(&velocities[cluster.balls.clone()], self.step);
            for ((place, start), end) in cluster.balls.clone().zip(&cluster.arms).zip(&motion.arms) {
                velocities[place] = motion.velocity + (end - start) / self.step;
            }
        }
        self.halo.own().iter().map(|&place| velocities[place]).collect()
    }

    /// Turns the own balls of clusters over the step as these do that are next to wanted velocities, and gives them the motions that they have at its
    /// end. Collective.
    pub fn turn(&self, peers: Peers, wanted: &[SVector<f64, D>], moves: &mut [Twist<D>], twists: &mut [Twist<D>]) {
        let velocities = self.halo.spread_vectors(peers, wanted);
        let mut place_of = vec![None; self.halo.len()];
        self.halo.own().iter().enumerate().for_each(|(body, &place)| place_of[place] = Some(body));
        for cluster in &self.clusters {
            let motion = cluster.motion(&velocities[cluster.balls.clone()], self.step);
            for (place, arm) in cluster.balls.clone().zip(&motion.arms) {
                let Some(body) = place_of[place] else { continue };
                let [over, after] = motion.spins;
                moves[body].spin = over;
                twists[body] = Twist { velocity: motion.velocity + after * arm, spin: after };
            }
        }
    }
}

impl<const D: usize> RigidCluster<D> {
    /// Its motion when its balls have these velocities before they are tied.
    fn motion(&self, velocities: &[SVector<f64, D>], step: f64) -> RigidMotion<D> {
        let momentum = moment(&self.arms, velocities) + self.own_momentum;
        let turned = |spin: &SMatrix<f64, D, D>, by: f64| -> Vec<SVector<f64, D>> { apply(turn(spin, by) * self.rotation, &self.offsets) };
        let mut spin = spin_of(&self.arms, self.own, &momentum);
        for _ in 0..CORRECTIONS {
            spin = spin_of(&turned(&spin, 0.5 * step), self.own, &momentum);
        }
        let arms = turned(&spin, step);
        let after = spin_of(&arms, self.own, &momentum);
        RigidMotion { velocity: velocities.iter().sum::<SVector<f64, D>>() / velocities.len() as f64, spins: [spin, after], arms }
    }
}

fn apply<const D: usize>(rotation: SMatrix<f64, D, D>, offsets: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
    offsets.iter().map(|offset| rotation * offset).collect()
}

fn from_mean<const D: usize>(centers: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
    let middle = centers.iter().sum::<SVector<f64, D>>() / centers.len() as f64;
    centers.iter().map(|center| center - middle).collect()
}

/// Matrices of all bodies that are seen, from those of the own ones. Collective.
fn spread_matrices<const D: usize>(peers: Peers, halo: &Halo, own: impl Iterator<Item = SMatrix<f64, D, D>>) -> Vec<SMatrix<f64, D, D>> {
    let own: Vec<SMatrix<f64, D, D>> = own.collect();
    let mut seen: Vec<SMatrix<f64, D, D>> = vec![SMatrix::zeros(); halo.len()];
    for column in 0..D {
        let of_own: Vec<SVector<f64, D>> = own.iter().map(|matrix| matrix.column(column).into_owned()).collect();
        halo.spread_vectors(peers, &of_own).iter().zip(&mut seen).for_each(|(from, to)| to.set_column(column, from));
    }
    seen
}
