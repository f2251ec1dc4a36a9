//! The staggered grid of the box: numbering, stencils, matrices, interpolation. It knows walls, but no bodies.

pub mod curl;
pub mod dirichlet;
pub mod interpolation;
pub mod operators;
mod partition;
mod pencils;
mod quick;
mod redistribution;
mod staggered;
pub mod stencil;

pub use partition::{Block, Partition, factorisations};
pub use pencils::Pencils;
pub use quick::quick_spacing;
pub use redistribution::{BlockLayout, Exchange, Redistribution};
pub use staggered::{FEWEST_CELLS, Grid, Index, MOST_INDEX, MOST_UNKNOWNS, Node, WIDER_INDICES, cells_along};
