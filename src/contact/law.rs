//! The laws of contact.

use super::Repulsion;

/// A law of contact with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// Bodies do not notice contact.
    None,
    /// Bodies do not overlap at the end of a step and do not bounce.
    Inelastic,
    /// As inelastic, but what was pressed together sticks ([`gluey`](super::gluey)).
    Gluey {
        /// The memory of a contact does not fall below this, which is not positive.
        least: f64,
    },
    /// Bodies push each other apart before they touch.
    Repulsion(Repulsion),
}
