//! Inelastic contact: bodies do not overlap at the end of a step and do not bounce.

use super::{ContactLaw, Interaction, Touch};

/// Inelastic contact ([`contact`](crate::contact)).
#[derive(Debug, Clone, Copy)]
pub struct Inelastic;

impl<const D: usize> Interaction<D> for Inelastic {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn describe(&self) -> String {
        "inelastic, one quadratic program a step, split into islands".into()
    }

    fn contact(&self) -> ContactLaw<'_, D> {
        Touch::Hard.into()
    }
}
