//! How contacts are held in a coupled solve.

use nalgebra::SVector;

use crate::friction::cone::ContactState;

/// How a contact, or what turns one, is held in a coupled solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldContact<const D: usize> {
    /// What it does.
    pub state: ContactState,
    /// Force on the partner near which it is looked for; of what turns a contact the couple over the reduced radius, an axial vector.
    pub force: SVector<f64, D>,
    /// Direction of friction on the partner where it slips; zero where it does so freely.
    pub direction: SVector<f64, D>,
    /// Speed of the slip over the force of friction.
    pub ease: f64,
    /// Whether it slips along one line, one way or the other.
    pub along_line: bool,
}

impl<const D: usize> HeldContact<D> {
    /// Whether friction resists a slip: not below the critical load, nor of smooth surfaces.
    pub(super) fn rubs(&self) -> bool {
        self.direction != SVector::<f64, D>::zeros()
    }

    /// Whether two say the same: of slips along a line there are two, along a plane any number.
    pub fn is_like(&self, other: &HeldContact<D>) -> bool {
        if self.state == ContactState::Slipping && !(self.rubs() && other.rubs()) {
            return other.state == self.state && self.rubs() == other.rubs();
        }
        let same_way = !self.along_line || self.state != ContactState::Slipping || self.direction.dot(&other.direction) > 0.0;
        self.state == other.state && same_way
    }
}
