//! A relative motion of a few bodies, or of a body and a wall, that is constrained or resisted.

use nalgebra::SVector;

/// Compliance that a contact has in the approximation, over the mobility of its ends: redundant contacts then do no harm. Its inverse
/// magnifies rounding.
const SHIFT: f64 = 1e-4;

/// What a constraint counts of the coefficients of a body's rigid modes, translations first.
pub type RigidVector = SVector<f64, 6>;

/// One free body of a constraint.
#[derive(Debug, Clone, Copy)]
pub struct ConstraintSide {
    /// The body.
    pub body: usize,
    /// What its motion counts for the rate.
    pub weights: RigidVector,
    /// How a unit force pushes it: the same, but of contacts that slip.
    pub push: RigidVector,
    /// Multiplier of a unit weight that a unit of the unknown stands for.
    pub multiplier: f64,
    /// Velocities in unbounded fluid that unit multipliers of rigid modes cause.
    pub mobilities: RigidVector,
}

impl ConstraintSide {
    /// Rate that a unit of the unknown causes through the body's own mobility.
    fn mobility(&self) -> f64 {
        self.multiplier * self.push.component_mul(&self.mobilities).dot(&self.weights)
    }
}

/// A contact, a spring, or a way of a film.
#[derive(Debug, Clone)]
pub struct PairConstraint {
    /// Its free bodies, the first two of them.
    pub ends: [Option<ConstraintSide>; 2],
    /// The others: of a spring that takes more than two.
    pub others: Vec<ConstraintSide>,
    /// Rate wanted, without what is known to move.
    pub rate: f64,
    /// Rate that a unit of the unknown gives way by: zero for contacts.
    pub compliance: f64,
    /// Factor of its row in the linear system.
    pub weight: f64,
    /// Whether it belongs to this rank.
    pub owned: bool,
    /// Whether its compliance, small as it is, is all that it has in the approximation: that of contacts with friction does no harm if they are redundant.
    pub regular: bool,
}

impl PairConstraint {
    /// A constraint that no body is an end of yet.
    pub fn new(rate: f64, compliance: f64, owned: bool) -> PairConstraint {
        PairConstraint { ends: [None; 2], others: Vec::new(), rate, compliance, weight: 1.0, owned, regular: false }
    }

    /// Makes a body one of its ends.
    pub fn add(&mut self, side: ConstraintSide) {
        match self.ends.iter_mut().find(|end| end.is_none()) {
            Some(end) => *end = Some(side),
            None => self.others.push(side),
        }
    }

    /// Whether a unit force pushes its bodies as their motions count.
    pub fn symmetric(&self) -> bool {
        self.sides().all(|side| side.push == side.weights)
    }

    /// Its free bodies.
    pub fn sides(&self) -> impl Iterator<Item = &ConstraintSide> {
        self.ends.iter().flatten().chain(&self.others)
    }

    /// Makes its row one of velocities, however large the rates that a soft spring would give way by.
    pub fn balance(&mut self) {
        let mobility = self.mobility();
        self.weight = if mobility > 0.0 { mobility / (mobility + self.compliance) } else { 1.0 };
    }

    /// Rate that a unit of the unknown causes through its bodies' own mobilities.
    fn mobility(&self) -> f64 {
        self.sides().map(ConstraintSide::mobility).sum()
    }

    /// Its compliance in the approximation, which is never zero.
    pub fn stiff_compliance(&self) -> f64 {
        let shift = if self.regular { 0.0 } else { SHIFT * self.mobility() };
        (self.compliance + shift).max(f64::MIN_POSITIVE)
    }
}
