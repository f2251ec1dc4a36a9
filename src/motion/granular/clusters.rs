//! Rigid clusters of dry bodies: the balls of each move over a step as one body that has their momentum and their angular momentum.
//!
//! The motion of a cluster is the nearest to those of its balls, weighed by masses and moments of inertia. It turns by the spin that its angular momentum
//! has half way through the step, and the angular momentum is kept from step to step, so that a free body turns as Euler's equations say, to second order.

use std::ops::Range;

use nalgebra::{SMatrix, SVector, Vector3};

use crate::{
    body::{Halo, Twist, components, planes, skew},
    contact::{RIGID, RigidBalls},
    friction::RigidTwists,
    interaction::Cluster,
    motion::clusters::{inertia, moment, spin_of, unit},
    parallel::Peers,
    setup::{State, state::turn},
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
    pub fn new(peers: Peers, clusters: &[Cluster<D>], state: &State<D>, own: &[f64], moves: &[Twist<D>], step: f64) -> GranularClusters<D> {
        let numbers = state.numbers();
        let owns = |cluster: &&Cluster<D>| {
            let next = numbers.get(numbers.partition_point(|&number| number < cluster.bodies.start));
            next.is_some_and(|&next| next < cluster.bodies.end)
        };
        let owned: Vec<&Cluster<D>> = clusters.iter().filter(owns).collect();
        let halo = Halo::of_numbers(peers, &numbers, owned.iter().flat_map(|cluster| cluster.bodies.clone()));
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
        GranularClusters { clusters: owned.iter().map(rigid).collect(), halo, step }
    }

    /// Gives the own balls of clusters the velocities that carry them over the step as rigid motions do, next to wanted ones that contacts change. Collective.
    pub fn hold(&self, peers: Peers, wanted: [&[SVector<f64, D>]; 2], velocities: &mut [SVector<f64, D>]) {
        let (wanted, place_of) = (self.spread(peers, wanted), self.places_of_own());
        for cluster in &self.clusters {
            let motion = cluster.motion(cluster.of(&wanted), self.step);
            for ((place, start), end) in cluster.balls.clone().zip(&cluster.arms).zip(&motion.arms) {
                let velocity = motion.velocity + (end - start) / self.step;
                place_of[place].into_iter().for_each(|body| velocities[body] = velocity);
            }
        }
    }

    /// Puts the velocities that the own balls of clusters would have without what contacts change wanted ones by, as far as they answer linearly to that,
    /// into `linear`, where they are `held` now, as [`hold`](Self::hold) has found; and tells how the balls move, by number, of the clusters of which this
    /// rank owns the first one. Collective.
    pub fn linear(
        &self,
        peers: Peers,
        wanted: [&[SVector<f64, D>]; 2],
        held: &[SVector<f64, D>],
        weights: &[f64],
        linear: &mut [SVector<f64, D>],
    ) -> Vec<RigidBalls<D>> {
        let (wanted, weights, place_of) = (self.spread(peers, wanted), self.halo.spread(peers, weights), self.places_of_own());
        let mut rigid = Vec::new();
        for cluster in &self.clusters {
            let weight = weights[cluster.balls.start];
            let moved = cluster.moved(cluster.of(&wanted), self.step, weight);
            let balls = || cluster.balls.clone().zip(&moved);
            let unknowns: SVector<f64, RIGID> = balls().map(|(place, moved)| moved.transpose() * wanted[1][place] * weight).sum();
            for (place, moved) in balls() {
                place_of[place].into_iter().for_each(|body| linear[body] = held[body] - moved * unknowns);
            }
            if self.halo.owns(cluster.balls.start) {
                rigid.push(RigidBalls(balls().map(|(place, moved)| (self.halo.numbers()[place], *moved)).collect()));
            }
        }
        rigid
    }

    /// Puts the motions over the step that the own balls of clusters would have without what contacts change motions by, as far as they answer linearly to
    /// that, into `linear`, where velocities are `held` now; and tells how the balls move, by number, as [`linear`](Self::linear). Spins were changed when the
    /// clusters were made. Collective.
    pub fn linear_twists(
        &self,
        peers: Peers,
        [wanted, changes]: [&[Twist<D>]; 2],
        held: &[SVector<f64, D>],
        masses: &[f64],
        linear: &mut [Twist<D>],
    ) -> Vec<RigidTwists<D>> {
        let velocities = [wanted, changes].map(|twists| twists.iter().map(|twist| twist.velocity).collect::<Vec<SVector<f64, D>>>());
        let velocities = self.spread(peers, [&velocities[0], &velocities[1]]);
        let spins = spread_matrices(peers, &self.halo, changes.iter().map(|change| change.spin));
        let (masses, place_of) = (self.halo.spread(peers, masses), self.places_of_own());
        let mut rigid = Vec::new();
        for cluster in &self.clusters {
            let (mass, of_balls) = (masses[cluster.balls.start], cluster.of(&velocities));
            let (moved, spin) = (cluster.moved(of_balls, self.step, mass), cluster.spun(of_balls, self.step, mass));
            let balls = || cluster.balls.clone().zip(&moved);
            let spun: SMatrix<f64, D, D> = spins[cluster.balls.clone()].iter().sum();
            let turned = Vector3::from_fn(|plane, _| components(&spun).get(plane).copied().unwrap_or(0.0)) * (cluster.own * mass);
            let pushed: SVector<f64, RIGID> = balls().map(|(place, moved)| moved.transpose() * velocities[1][place] * mass).sum();
            let unknowns = pushed + spin.transpose() * turned;
            let whole = cluster.motion(of_balls, self.step).spins[0];
            let without = whole - skew::<D>((spin * unknowns).as_slice());
            for (place, moved) in balls() {
                let velocity = |body: usize| held[body] - moved * unknowns;
                place_of[place].into_iter().for_each(|body| linear[body] = Twist { velocity: velocity(body), spin: without });
            }
            if self.halo.owns(cluster.balls.start) {
                rigid.push(RigidTwists { balls: balls().map(|(place, moved)| (self.halo.numbers()[place], *moved)).collect(), spin });
            }
        }
        rigid
    }

    /// Velocities, and changes of them, of all bodies that are seen. Collective.
    fn spread(&self, peers: Peers, own: [&[SVector<f64, D>]; 2]) -> [Vec<SVector<f64, D>>; 2] {
        own.map(|own| self.halo.spread_vectors(peers, own))
    }

    /// For each place which own body is there.
    fn places_of_own(&self) -> Vec<Option<usize>> {
        let mut place_of = vec![None; self.halo.len()];
        self.halo.own().iter().enumerate().for_each(|(body, &place)| place_of[place] = Some(body));
        place_of
    }

    /// Turns the own balls of clusters over the step as these do that are next to wanted velocities which contacts change, and gives them the motions that
    /// they have at its end. Collective.
    pub fn turn(&self, peers: Peers, wanted: [&[SVector<f64, D>]; 2], moves: &mut [Twist<D>], twists: &mut [Twist<D>]) {
        let (wanted, place_of) = (self.spread(peers, wanted), self.places_of_own());
        for cluster in &self.clusters {
            let motion = cluster.motion(cluster.of(&wanted), self.step);
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
    /// What its balls have of what is known of all.
    fn of<'a>(&self, [velocities, changes]: &'a [Vec<SVector<f64, D>>; 2]) -> [&'a [SVector<f64, D>]; 2] {
        [&velocities[self.balls.clone()], &changes[self.balls.clone()]]
    }

    /// Its motion when its balls have these velocities before they are tied, and contacts change them so: that acts where balls are at the end of the step,
    /// as contacts are kept there, so that forces which move the cluster alike do so wherever they act.
    fn motion(&self, [velocities, changes]: [&[SVector<f64, D>]; 2], step: f64) -> RigidMotion<D> {
        let before = moment(&self.arms, velocities) + self.own_momentum;
        let momentum = |arms: &[SVector<f64, D>]| before + moment(arms, changes);
        let turned = |spin: &SMatrix<f64, D, D>, by: f64| -> Vec<SVector<f64, D>> { apply(turn(spin, by) * self.rotation, &self.offsets) };
        let mut spin = spin_of(&self.arms, self.own, &momentum(&self.arms));
        for _ in 0..CORRECTIONS {
            spin = spin_of(&turned(&spin, 0.5 * step), self.own, &momentum(&turned(&spin, step)));
        }
        let arms = turned(&spin, step);
        let after = spin_of(&arms, self.own, &momentum(&arms));
        let mean = |vectors: &[SVector<f64, D>]| vectors.iter().sum::<SVector<f64, D>>() / vectors.len() as f64;
        RigidMotion { velocity: mean(velocities) + mean(changes), spins: [spin, after], arms }
    }

    /// How its balls move for small changes of its [`motion`](Self::motion), each ball resisting with a weight.
    fn moved(&self, wanted: [&[SVector<f64, D>]; 2], step: f64, weight: f64) -> Vec<SMatrix<f64, D, RIGID>> {
        let arms = self.motion(wanted, step).arms;
        let turns = inertia(&arms, self.own).l().transpose().try_inverse().expect("an inertia is positive definite");
        let translation = 1.0 / (weight * arms.len() as f64).sqrt();
        let moved = |arm: &SVector<f64, D>| {
            let mut moved = SMatrix::<f64, D, RIGID>::zeros();
            for axis in 0..D {
                moved[(axis, axis)] = translation;
            }
            for (turn, column) in turns.column_iter().enumerate() {
                let about = |plane: usize| unit(plane) * arm * column[plane];
                let velocity: SVector<f64, D> = (0..planes::<D>().len()).map(about).sum();
                moved.set_column(D + turn, &(velocity / weight.sqrt()));
            }
            moved
        };
        arms.iter().map(moved).collect()
    }
}

impl<const D: usize> RigidCluster<D> {
    /// How they spin for the same unknowns as [`moved`](Self::moved).
    fn spun(&self, wanted: [&[SVector<f64, D>]; 2], step: f64, mass: f64) -> SMatrix<f64, 3, RIGID> {
        let arms = self.motion(wanted, step).arms;
        let turns = inertia(&arms, self.own).l().transpose().try_inverse().expect("an inertia is positive definite");
        let mut spun = SMatrix::zeros();
        for (turn, column) in turns.column_iter().enumerate() {
            column.iter().enumerate().for_each(|(plane, entry)| spun[(plane, D + turn)] = entry / mass.sqrt());
        }
        spun
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
    let mut spread: Vec<SMatrix<f64, D, D>> = vec![SMatrix::zeros(); halo.len()];
    for column in 0..D {
        let of_own: Vec<SVector<f64, D>> = own.iter().map(|matrix| matrix.column(column).into_owned()).collect();
        halo.spread_vectors(peers, &of_own).iter().zip(&mut spread).for_each(|(from, to)| to.set_column(column, from));
    }
    spread
}
