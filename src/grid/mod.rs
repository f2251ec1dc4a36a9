//! The staggered grid of the box: numbering, stencils, matrices, interpolation. It knows walls, but no bodies.

pub mod interpolation;
pub mod operators;
mod partition;
mod staggered;
pub mod stencil;

pub use partition::{Block, Partition};
pub use staggered::{Grid, Index, Node};
