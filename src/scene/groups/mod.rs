//! Groups of bodies: what they are, how large, where they are placed, and what ties them together.

pub mod bodies;
pub mod chains;
pub mod clusters;
pub(in crate::scene) mod keys;
pub mod region;
pub mod sizes;
