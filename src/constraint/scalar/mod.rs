//! Inclusions in which a scalar is constant: the same blocks as those of bodies in a fluid, with one component and one rigid mode.
//!
//! With `A` minus the Laplacian at cell centres, which no inclusion changes, and the multipliers `c`,
//!
//! ```text
//! A u - C c = f (chi + s)      C: where the multipliers act,   s: what confines the source,  chi = 1 outside inclusions
//! J u + E c + f e = values     J: where the scalar is tested,  E, e: what is known beside the grid
//! ```
//!
//! and the values are those of an unknown constant on each inclusion, out of which nothing flows net.

mod blocks;
mod cells;
mod distributed;
mod envelope;
mod graph;
mod inclusion;
mod mean_value;
mod penalty;
mod sharp;

pub use blocks::ScalarBlocks;
pub use inclusion::InclusionMethod;
