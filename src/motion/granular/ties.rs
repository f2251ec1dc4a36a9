//! What ties dry bodies to each other in a step: bonds of chains and rigid clusters.

use std::collections::BTreeSet;

use nalgebra::SVector;

use super::{
    chains::{GranularChains, GranularStep},
    clusters::GranularClusters,
    migration::Constants,
};
use crate::{
    body::{Row, Twist},
    contact::RigidBalls,
    friction::RigidTwists,
    interaction::Interactions,
    parallel::Peers,
    setup::State,
};

/// The ties of the bodies of this rank.
pub struct Ties<const D: usize> {
    chains: Option<GranularChains<D>>,
    clusters: Option<GranularClusters<D>>,
}

impl<const D: usize> Ties<D> {
    /// Those of bodies that would move so without ties; none where nothing is tied. Collective.
    pub fn new(
        peers: Peers,
        interactions: &Interactions<D>,
        state: &State<D>,
        bodies: &[Constants<D>],
        moves: &[Twist<D>],
        step: GranularStep,
    ) -> Option<Ties<D>> {
        let (chains, clusters) = (interactions.chains(), interactions.clusters());
        let masses = || -> Vec<f64> { bodies.iter().map(|body| body.mass).collect() };
        let chains = (!chains.is_empty()).then(|| GranularChains::new(peers, interactions, &chains, state, &masses(), step));
        let clusters = (!clusters.is_empty()).then(|| GranularClusters::new(peers, clusters, state, &inertias(bodies), moves, step.length));
        (chains.is_some() || clusters.is_some()).then_some(Ties { chains, clusters })
    }

    /// Gives balls of clusters the motions of their clusters where they are, next to those that forces make of them one by one. Collective.
    pub fn turn_clusters_on(
        peers: Peers,
        interactions: &Interactions<D>,
        state: &State<D>,
        bodies: &[Constants<D>],
        pushed: &[Twist<D>],
        twists: &mut [Twist<D>],
    ) {
        let clusters = GranularClusters::new(peers, interactions.clusters(), state, &inertias(bodies), pushed, 0.0);
        let velocities: Vec<SVector<f64, D>> = pushed.iter().map(|twist| twist.velocity).collect();
        let unchanged = vec![SVector::zeros(); pushed.len()];
        clusters.turn(peers, [&velocities, &unchanged], &mut pushed.to_vec(), twists);
    }

    /// The velocities that carry the own bodies over the step by ties alone, next to wanted ones that contacts change. Collective.
    pub fn hold(&mut self, peers: Peers, wanted: &[SVector<f64, D>], changes: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let free: Vec<SVector<f64, D>> = wanted.iter().zip(changes).map(|(wanted, change)| wanted + change).collect();
        let mut held = self.chains.as_mut().map_or_else(|| free.clone(), |chains| chains.hold(peers, &free));
        if let Some(clusters) = &self.clusters {
            clusters.hold(peers, [wanted, changes], &mut held);
        }
        held
    }

    /// The velocities that the own bodies would have without what contacts change wanted ones by, where they are `held` now: of balls of clusters as far as
    /// these answer linearly to forces, of others those wanted; and how the balls of clusters move. Collective.
    pub fn linear(
        &self,
        peers: Peers,
        [wanted, changes]: [&[SVector<f64, D>]; 2],
        held: &[SVector<f64, D>],
        weights: &[f64],
    ) -> (Vec<SVector<f64, D>>, Vec<RigidBalls<D>>) {
        let mut linear = wanted.to_vec();
        let clusters = self.clusters.as_ref().map(|clusters| clusters.linear(peers, [wanted, changes], held, weights, &mut linear));
        (linear, clusters.unwrap_or_default())
    }

    /// The motions of the own bodies over the step without what contacts change them by, of balls of clusters as far as these answer linearly to that, of others
    /// those wanted; and how the balls of clusters move. Collective.
    pub fn linear_twists(
        &self,
        peers: Peers,
        wanted: &[Twist<D>],
        changes: &[Twist<D>],
        held: &[SVector<f64, D>],
        masses: &[f64],
    ) -> (Vec<Twist<D>>, Vec<RigidTwists<D>>) {
        let mut linear = wanted.to_vec();
        let clusters = self.clusters.as_ref().map(|clusters| clusters.linear_twists(peers, [wanted, changes], held, masses, &mut linear));
        (linear, clusters.unwrap_or_default())
    }

    /// Bonds as rows, as [`GranularChains::ties`].
    pub fn rows(&self, touching: &BTreeSet<usize>) -> Vec<Row<D>> {
        self.chains.as_ref().map_or(Vec::new(), |chains| chains.ties(touching))
    }

    /// See [`GranularChains::missed`].
    pub fn missed(&self) -> f64 {
        self.chains.as_ref().map_or(0.0, GranularChains::missed)
    }

    /// Turns balls of clusters over the step, and gives them the motions that they have at its end, as [`GranularClusters::turn`]. Collective.
    pub fn turn(&self, peers: Peers, wanted: [&[SVector<f64, D>]; 2], moves: &mut [Twist<D>], twists: &mut [Twist<D>]) {
        if let Some(clusters) = &self.clusters {
            clusters.turn(peers, wanted, moves, twists);
        }
    }
}

/// Moments of inertia over masses.
fn inertias<const D: usize>(bodies: &[Constants<D>]) -> Vec<f64> {
    bodies.iter().map(|body| body.inertia / body.mass).collect()
}
