//! The choice of an inverse.

use super::{
    HypreInverse, Stokes, StokesInverse, TransformInverse,
    slender::{FlowAlong, SlenderInverse},
};
use crate::{error::Result, geometry::Domain, grid::Grid};

/// The inverses that a run can use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InverseMethod {
    /// Multigrid: any box.
    #[default]
    Hypre,
    /// Fourier transforms: exact, in boxes with walls along one axis at most.
    Transform,
}

impl InverseMethod {
    /// The fastest that a box allows.
    pub fn fastest<const D: usize>(domain: &Domain<D>) -> InverseMethod {
        if TransformInverse::fits(domain) { InverseMethod::Transform } else { InverseMethod::Hypre }
    }

    /// Its word in a scene file.
    pub fn word(self) -> &'static str {
        match self {
            InverseMethod::Hypre => "hypre",
            InverseMethod::Transform => "transform",
        }
    }

    /// Sets one up.
    ///
    /// # Errors
    /// The box does not allow it, or PETSc has no memory for it.
    pub fn set_up<const D: usize>(self, stokes: &Stokes<D>, grid: &Grid<D>) -> Result<Box<dyn StokesInverse<D>>> {
        match self {
            InverseMethod::Hypre => by_multigrid(stokes, grid),
            InverseMethod::Transform => Ok(Box::new(TransformInverse::new(stokes, grid)?)),
        }
    }
}

/// The approximate inverse by multigrid that suits a box.
///
/// # Errors
/// PETSc has no memory for it.
pub fn by_multigrid<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>) -> Result<Box<dyn StokesInverse<D>>> {
    let local = HypreInverse::new(stokes, grid)?;
    match FlowAlong::of(stokes, grid) {
        Some(along) => Ok(Box::new(SlenderInverse::new(stokes, along, local)?)),
        None => Ok(Box::new(local)),
    }
}
