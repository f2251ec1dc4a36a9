//! What friction needs to know of the bodies of a rank, and what it finds.

use std::collections::BTreeMap;

use nalgebra::{SMatrix, SVector};

use super::SurfaceFriction;
use crate::{
    body::Twist,
    contact::{ContactForce, Identity, KktReport},
};

/// The own bodies of a rank as friction knows them, besides their [`Problem`](crate::contact::Problem), whose weights are masses over the duration.
#[derive(Debug, Clone, Copy)]
pub struct FrictionShare<'a, const D: usize> {
    /// Coefficients of friction of all surfaces.
    pub surfaces: &'a SurfaceFriction,
    /// Motions at the start of the step.
    pub starts: &'a [Twist<D>],
    /// Spins wanted.
    pub spins: &'a [SMatrix<f64, D, D>],
    /// Moments of inertia, infinite where a motion is given.
    pub inertias: &'a [f64],
    /// Over how long forces act on the velocities of the step: impulses are forces times this.
    pub duration: f64,
    /// Residual to which forces are found.
    pub tolerance: f64,
    /// Tangential forces of the last step by contact: a place to start from.
    pub last: &'a BTreeMap<Identity<D>, SVector<f64, D>>,
}

/// A rank's part of a projection with friction.
pub struct FrictionProjection<const D: usize> {
    /// Velocities of its own bodies.
    pub velocities: Vec<SVector<f64, D>>,
    /// Their spins.
    pub spins: Vec<SMatrix<f64, D, D>>,
    /// Forces of their contacts, of which many may be zero; bodies are named by their numbers.
    pub forces: Vec<ContactForce<D>>,
    /// How good the answer is, and what it cost; of all ranks.
    pub kkt_report: KktReport,
}
