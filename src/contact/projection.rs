//! What a projection comes to.

use nalgebra::SVector;

use super::{ContactForce, KktReport, View};

/// Velocities that let nothing overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection<const D: usize> {
    /// Velocities of the bodies.
    pub velocities: Vec<SVector<f64, D>>,
    /// All contacts of the problem solved, with their forces, of which many may be zero; sorted by
    /// [`Contact::identity`](super::Contact::identity). The sum of its contact forces on a body is `w (v - wanted)`, for bodies that give way.
    pub forces: Vec<ContactForce<D>>,
    /// How good the answer is, and what it cost.
    pub kkt_report: KktReport,
}

/// A rank's part of a projection.
pub struct ProjectionShare<const D: usize> {
    /// Velocities of its own bodies, and the forces of all contacts of one of them, between bodies by their places in the view; the report is that of
    /// the whole.
    pub projection: Projection<D>,
    /// The bodies that it saw.
    pub view: View<D>,
}
