//! A relative motion of a few bodies, or of a body and a wall, that is constrained or resisted.

use nalgebra::SVector;

use crate::interaction::MOST_ENDS;

/// Compliance that a contact has in the approximation, over the mobility of its ends: redundant contacts then do no harm. Its inverse
/// magnifies rounding.
const SHIFT: f64 = 1e-4;

/// What a link counts of the coefficients of a body's rigid modes, translations first.
pub type RigidVector = SVector<f64, 6>;

/// One free body of a link.
#[derive(Debug, Clone, Copy)]
pub struct ConstraintSide {
    /// The body.
    pub body: usize,
    /// What its motion counts for the rate, and so how a unit force pushes it.
    pub weights: RigidVector,
    /// Multiplier of a unit weight that a unit of the unknown stands for.
    pub multiplier: f64,
    /// Velocities in unbounded fluid that unit multipliers of rigid modes cause.
    pub mobilities: RigidVector,
}

impl ConstraintSide {
    /// Rate that a unit of the unknown causes through the body's own mobility.
    fn mobility(&self) -> f64 {
        self.multiplier * self.weights.component_mul(&self.mobilities).dot(&self.weights)
    }
}

/// A contact, a spring, or a way of a film.
#[derive(Debug, Clone)]
pub struct PairConstraint {
    /// Its free bodies.
    pub ends: [Option<ConstraintSide>; MOST_ENDS],
    /// Rate wanted, without what is known to move.
    pub rate: f64,
    /// Rate that a unit of the unknown gives way by: zero for contacts.
    pub compliance: f64,
    /// Whether it belongs to this rank.
    pub owned: bool,
}

impl PairConstraint {
    /// Its compliance in the approximation, which is never zero.
    pub fn stiff_compliance(&self) -> f64 {
        let mobility: f64 = self.ends.iter().flatten().map(ConstraintSide::mobility).sum();
        (self.compliance + SHIFT * mobility).max(f64::MIN_POSITIVE)
    }
}
