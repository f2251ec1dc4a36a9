//! A scene resolved in its dimension: numbers only, nothing left to choose.

use crate::{body::Body, flow::Drive, geometry::Domain};

/// A body with the number of its multiplier modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuspendedBody<const D: usize> {
    /// The body.
    pub body: Body<D>,
    /// Highest order of its modes.
    pub order: usize,
}

/// What to solve.
#[derive(Debug, Clone)]
pub struct Setup<const D: usize> {
    /// The box.
    pub domain: Domain<D>,
    /// Spacing asked for; whole numbers of cells make it differ a little along each axis.
    pub spacing: f64,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// What drives the flow.
    pub drive: Drive<D>,
    /// The bodies.
    pub bodies: Vec<SuspendedBody<D>>,
    /// Relative residual of the linear solver.
    pub tolerance: f64,
}
