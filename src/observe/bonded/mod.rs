//! Bodies that belong together: chains, clusters, membranes.

pub mod cell_geometry;
pub mod chain_geometry;
pub mod chains;
pub mod clusters;
pub mod membranes;
pub mod tied;
