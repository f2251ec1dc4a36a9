//! Bodies that belong together: chains, clusters, membranes.

pub mod chains;
pub mod clusters;
pub mod membranes;
