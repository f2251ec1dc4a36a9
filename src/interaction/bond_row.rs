//! Rows of the coupled system by which a few bodies are tied to each other: of springs, and of clusters.

use nalgebra::{SMatrix, SVector};

use crate::constraint::lubrication::RigidFunctional;

/// A row `rate of a coordinate + compliance force = wanted rate`.
#[derive(Debug, Clone, PartialEq)]
pub struct BondRow<const D: usize> {
    /// The bodies, with what the motion of each counts for the rate, and so how a unit force pushes and turns it.
    pub ends: Vec<(usize, RigidFunctional<D>)>,
    /// The rate wanted.
    pub rate: f64,
    /// Rate over force; zero for what cannot give way.
    pub compliance: f64,
}

impl<const D: usize> BondRow<D> {
    /// What a force along the coordinate adds to the stress, times volume: minus the first moment of the forces on bodies, of which torques are the
    /// antisymmetric part.
    pub fn stress(&self, force: f64, centers: &[SVector<f64, D>]) -> SMatrix<f64, D, D> {
        let moment = |(body, push): &(usize, RigidFunctional<D>)| push.direction * centers[*body].transpose() + push.turn * 0.5;
        self.ends.iter().map(moment).sum::<SMatrix<f64, D, D>>() * -force
    }

    /// What rows with these forces add to the stress, times volume; nothing without rows.
    pub fn total_stress(rows: &[BondRow<D>], forces: &[f64], centers: &[SVector<f64, D>]) -> Option<SMatrix<f64, D, D>> {
        rows.iter().zip(forces).map(|(row, &force)| row.stress(force, centers)).reduce(|sum, stress| sum + stress)
    }
}
