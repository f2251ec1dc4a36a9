//! Near bodies feel each other: a correction, pair by pair, of the inverses of isolated bodies.
//!
//! ```text
//! P = sum over bodies of B_i^{-1}  +  sum over near pairs of ( B_ij^{-1} - B_i^{-1} (+) B_j^{-1} )
//! ```
//!
//! with `B_i` the block of an isolated body in unbounded fluid and `B_ij` that of two, rigid modes given in both: forces reach
//! far, and summed over pairs they would count too much. Where motions are given instead, a pair has neither net force nor torque, and the
//! blocks say what the motion of its bodies relative to each other calls for: of the free modes, and of the forces. In the frame of the
//! pair the second sum depends on the distance alone, and comes from a table; [`PairPreconditioner`] turns into that frame and back.

mod block;
mod pattern;
mod preconditioner;
mod table;

pub use preconditioner::{PairPreconditioner, RigidBlock};
pub use table::{Given, PairTables};
