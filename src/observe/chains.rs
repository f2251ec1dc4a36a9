//! How chains lie: their length from end to end, how far they are spread, and the energy in their bonds.

use std::ops::Range;

use nalgebra::SVector;

use crate::interaction::{Interactions, Spring};

/// Chains at an instant; means are over all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainNumbers {
    /// Energy of all bonds that can give way.
    pub bond_energy: f64,
    /// Mean distance from the first to the last bead.
    pub end_to_end: f64,
    /// Mean radius of gyration: root of the mean square distance of beads from the middle of their chain.
    pub gyration: f64,
}

impl ChainNumbers {
    /// Those of all bodies with these centres; nothing without chains.
    pub fn of<const D: usize>(interactions: &Interactions<D>, centers: &[SVector<f64, D>]) -> Option<ChainNumbers> {
        let chains = interactions.chains();
        if chains.is_empty() {
            return None;
        }
        let center = |body: usize| centers[body];
        let energy = |chain: &Range<usize>| interactions.springs_of(chain, &center).iter().map(Spring::energy).sum::<f64>();
        let mean = |of: &dyn Fn(&[SVector<f64, D>]) -> f64| {
            chains.iter().map(|chain| of(&centers[chain.clone()])).sum::<f64>() / chains.len() as f64
        };
        Some(ChainNumbers {
            bond_energy: chains.iter().map(energy).sum(),
            end_to_end: mean(&|beads| (beads[beads.len() - 1] - beads[0]).norm()),
            gyration: mean(&gyration),
        })
    }
}

fn gyration<const D: usize>(beads: &[SVector<f64, D>]) -> f64 {
    let middle = beads.iter().sum::<SVector<f64, D>>() / beads.len() as f64;
    (beads.iter().map(|bead| (bead - middle).norm_squared()).sum::<f64>() / beads.len() as f64).sqrt()
}
