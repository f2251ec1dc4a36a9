//! What friction needs to know of the bodies of a rank, and what it finds.

use nalgebra::{SMatrix, SVector};

use super::{SurfaceFriction, TangentialForce};
use crate::contact::{ContactForce, KktReport};

/// The own bodies of a rank as friction knows them, besides their [`Problem`](crate::contact::Problem), whose weights are masses over the step.
#[derive(Debug, Clone, Copy)]
pub struct FrictionShare<'a, const D: usize> {
    /// Coefficients of friction of all surfaces.
    pub surfaces: &'a SurfaceFriction,
    /// Spins wanted.
    pub spins: &'a [SMatrix<f64, D, D>],
    /// Moments of inertia, infinite where a motion is given.
    pub inertias: &'a [f64],
    /// Tangential forces of the last step: a place to start from.
    pub last: &'a [TangentialForce<D>],
}

/// A rank's part of a projection with friction.
pub struct FrictionProjection<const D: usize> {
    /// Velocities of its own bodies.
    pub velocities: Vec<SVector<f64, D>>,
    /// Their spins.
    pub spins: Vec<SMatrix<f64, D, D>>,
    /// Normal forces of their contacts, of which many may be zero; bodies are named by their numbers.
    pub forces: Vec<ContactForce<D>>,
    /// Tangential forces of those that press.
    pub tangential: Vec<TangentialForce<D>>,
    /// How good the answer is, and what it cost; of all ranks.
    pub kkt_report: KktReport,
}
