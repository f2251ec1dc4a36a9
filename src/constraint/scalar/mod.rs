//! The sharp method for a scalar: inclusions in which it is constant, with flux multipliers on their surfaces.
//!
//! With `A` minus the Laplacian at cell centres and the multipliers `c`,
//!
//! ```text
//! A u - C c = f (chi + s)      C: corrections of stencils for jumps,  s: those for the source's, chi = 1 outside inclusions
//! J u + E c + f e = values     J: interpolation on surfaces, tested with the modes,  E, e: what jumps add to it
//! ```
//!
//! As in the method for velocities, a stencil takes values from across a surface as its own side would extend them, and values on a
//! surface are interpolated from its inner extension, which in the solution is a constant.

mod assembly;
mod blocks;
mod nodes;

use std::rc::Rc;

use nalgebra::SVector;

use crate::surface::ScalarSurface;
pub use assembly::assemble;
pub use blocks::ScalarBlocks;

/// An inclusion in its place.
#[derive(Clone)]
pub struct PlacedInclusion<const D: usize> {
    /// Its centre, in the box or, for an image, beyond it.
    pub center: SVector<f64, D>,
    /// Its surface.
    pub surface: Rc<ScalarSurface<D>>,
}

impl<const D: usize> PlacedInclusion<D> {
    /// Whether a point at an offset from the centre lies outside.
    fn excludes(&self, offset: &SVector<f64, D>) -> bool {
        offset.norm_squared() > self.surface.modes.radius().powi(2)
    }
}
