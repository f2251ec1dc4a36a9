//! What is to be solved, as numbers: the bodies of a scene in their places, the box around them, where they are and how they move.

mod configuration;
pub(crate) mod placement;
mod resolved;
pub(crate) mod room;
pub(crate) mod state;

pub use configuration::Configuration;
pub use resolved::{Inertia, Setup, SuspendedBody};
pub use state::{ContactHistory, FoundShear, GivenPlace, Moving, Share, State, WallMotion};
