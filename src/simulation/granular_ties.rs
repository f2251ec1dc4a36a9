//! What ties dry bodies to each other in a step: bonds of chains and rigid clusters.

use std::collections::BTreeSet;

use nalgebra::SVector;

use super::{
    State,
    granular_chains::{GranularChains, GranularStep},
    granular_clusters::GranularClusters,
    migration::Constants,
};
use crate::{body::Twist, contact::Tie, interaction::Interactions, parallel::Peers};

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
        (state, bodies): (&State<D>, &[Constants<D>]),
        moves: &[Twist<D>],
        step: GranularStep,
    ) -> Option<Ties<D>> {
        let (chains, clusters) = (interactions.chains(), interactions.clusters());
        let masses = || -> Vec<f64> { bodies.iter().map(|body| body.mass).collect() };
        let inertias = || -> Vec<f64> { bodies.iter().map(|body| body.inertia / body.mass).collect() };
        let chains = (!chains.is_empty()).then(|| GranularChains::new(peers, interactions, &chains, (state, &masses()), step));
        let clusters = (!clusters.is_empty()).then(|| GranularClusters::new(peers, clusters, (state, &inertias()), moves, step.length));
        (chains.is_some() || clusters.is_some()).then_some(Ties { chains, clusters })
    }

    /// The velocities that carry the own bodies over the step by ties alone, next to wanted ones. Collective.
    pub fn hold(&mut self, peers: Peers, wanted: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let bonded = self.chains.as_mut().map(|chains| chains.hold(peers, wanted));
        let bonded = bonded.as_deref().unwrap_or(wanted);
        self.clusters.as_ref().map_or_else(|| bonded.to_vec(), |clusters| clusters.hold(peers, bonded))
    }

    /// Whether bonds alone tie bodies: clusters turn, which no rows describe.
    pub fn are_bonds(&self) -> bool {
        self.clusters.is_none()
    }

    /// Bonds as rows, as [`GranularChains::ties`].
    pub fn rows(&self, touching: &BTreeSet<usize>) -> Vec<Tie<D>> {
        self.chains.as_ref().map_or(Vec::new(), |chains| chains.ties(touching))
    }

    /// See [`GranularChains::missed`].
    pub fn missed(&self) -> f64 {
        self.chains.as_ref().map_or(0.0, GranularChains::missed)
    }

    /// Turns balls of clusters over the step, and gives them the motions that they have at its end, as [`GranularClusters::turn`]. Collective.
    pub fn turn(&self, peers: Peers, wanted: &[SVector<f64, D>], moves: &mut [Twist<D>], twists: &mut [Twist<D>]) {
        if let Some(clusters) = &self.clusters {
            clusters.turn(peers, wanted, moves, twists);
        }
    }
}
