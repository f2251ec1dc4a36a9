//! The choice of an inverse.

use super::{
    Stokes, StokesInverse, TransformInverse,
    multigrid::MultigridCycles,
    projection::{FieldInverse, ProjectionInverse},
    slender::{FlowAlong, SlenderInverse},
    transform::SeparatedInverse,
};
use crate::{
    error::{Error, Result},
    geometry::Domain,
    grid::Grid,
};

/// The inverses that a run can use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InverseMethod {
    /// Multigrid: any box.
    #[default]
    Hypre,
    /// Fourier transforms: exact in boxes with walls along one axis at most, in others of walls exact for each component of the velocity and for the pressure alone.
    Transform,
}

impl InverseMethod {
    /// The fastest that a box allows.
    pub fn fastest<const D: usize>(domain: &Domain<D>) -> InverseMethod {
        if InverseMethod::Transform.fits(domain) { InverseMethod::Transform } else { InverseMethod::Hypre }
    }

    /// Whether it serves a box.
    pub fn fits<const D: usize>(self, domain: &Domain<D>) -> bool {
        self == InverseMethod::Hypre || TransformInverse::fits(domain) || SeparatedInverse::fits(domain)
    }

    /// Whether it is the inverse itself in a box.
    pub fn is_exact<const D: usize>(self, domain: &Domain<D>) -> bool {
        self == InverseMethod::Transform && TransformInverse::fits(domain)
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
            InverseMethod::Hypre => by_projection(stokes, grid, Box::new(MultigridCycles::new(stokes, grid)?)),
            _ if self.is_exact(grid.domain()) => Ok(Box::new(TransformInverse::new(stokes, grid)?)),
            _ if self.fits(grid.domain()) => by_projection(stokes, grid, Box::new(SeparatedInverse::new(stokes, grid))),
            _ => Err(Error::refused("method.inverse = \"transform\" needs a box without an inflow; use method.inverse = \"hypre\"")),
        }
    }
}

fn by_projection<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>, inverses: Box<dyn FieldInverse>) -> Result<Box<dyn StokesInverse<D>>> {
    let local = ProjectionInverse::new(stokes, grid, inverses)?;
    match FlowAlong::of(stokes, grid) {
        Some(along) => Ok(Box::new(SlenderInverse::new(stokes, along, local)?)),
        None => Ok(Box::new(local)),
    }
}
