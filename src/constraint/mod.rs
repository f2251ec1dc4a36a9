//! How bodies enter the fluid: the blocks that they add to the linear system of the box.
//!
//! With the fluid unknowns `(u, p)` and the multipliers `c`,
//!
//! ```text
//! K (u, p) - C c = 0          C: spread
//! J u      + E c = velocity   J: sample,  E: local
//! ```
//!
//! A method of imposing rigidity fills [`Blocks`]; who solves with them does not know which method it was.

mod blocks;
mod conservation;
mod dense;
pub mod fitted;
mod interpolant;
mod layout;
mod near;
mod patch;
mod places;
mod rows;
mod scalar;
mod sharp;

pub use blocks::{Blocks, BodyBlocks, Situation};
pub use layout::Layout;
pub use near::{Crowd, NearPairs, PairTables};
pub use patch::Patch;
pub use scalar::{PlacedInclusion, ScalarBlocks, assemble as assemble_inclusion};
pub use sharp::{INTERPOLATION_REACH, Neighbour, Passed, Placed, Workspace, assemble, jump, passed};
