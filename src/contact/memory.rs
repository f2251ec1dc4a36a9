//! The forces of an earlier step, to start from.

use std::collections::HashMap;

use super::{Identity, identity_hash::ByIdentity};

/// Forces by contact.
#[derive(Debug, Clone, Default)]
pub struct Memory<const D: usize> {
    forces: HashMap<Identity<D>, f64, ByIdentity>,
}

impl<const D: usize> Memory<D> {
    /// The force of a contact; none if it is new.
    pub(crate) fn force(&self, identity: &Identity<D>) -> f64 {
        self.forces.get(identity).copied().unwrap_or(0.0)
    }
}

impl<const D: usize> FromIterator<(Identity<D>, f64)> for Memory<D> {
    fn from_iter<T: IntoIterator<Item = (Identity<D>, f64)>>(forces: T) -> Self {
        Self { forces: forces.into_iter().collect() }
    }
}
