//! Inverses, approximate or exact, of the Stokes operator.

mod cross_section;
mod hypre;
mod iterated;
mod slender;
mod transform;

pub use hypre::HypreInverse;
pub use iterated::IteratedInverse;
use slender::{FlowAlong, SlenderInverse};
pub use transform::{TransformInverse, Transposes};

use super::Stokes;
use crate::{
    error::Result,
    geometry::Domain,
    grid::Grid,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Report, System, Vector},
};

/// An approximate inverse of [`Stokes`]: a fixed linear map from balanced rows to fluid vectors.
///
/// Its output has no mean pressure, and in a fully periodic box no mean velocity.
pub trait StokesInverse<const D: usize> {
    /// `output = K^ rows`, where `rows` are balanced.
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()>;

    /// Whether it is the inverse itself, so that no residual of the fluid is left to be seen.
    fn exact(&self) -> bool {
        false
    }
}

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

/// What may help where the flow of a box without bodies is not found.
const REMEDY: &str = "method.inverse = \"transform\", where the box allows it, or a coarser grid may help";

/// The fluid without bodies, as a linear system; `inverse` preconditions it, if there is one.
pub struct FluidSystem<'a, const D: usize> {
    /// The operator.
    pub stokes: &'a Stokes<D>,
    /// Its approximate inverse.
    pub inverse: Option<&'a mut dyn StokesInverse<D>>,
}

impl<const D: usize> System for FluidSystem<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.stokes.multiply(input, output)?;
        self.stokes.balance(output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        match &mut self.inverse {
            Some(inverse) => inverse.precondition(self.stokes, input, output),
            None => output.copy_from(input),
        }
    }
}

impl<const D: usize> FluidSystem<'_, D> {
    /// Solves `K x = rhs` (balanced rows) to a relative residual of `tolerance`, starting from `x`; an exact inverse needs no iteration.
    ///
    /// # Errors
    /// [`Diverged`](crate::error::Error::Diverged) after `most_iterations` iterations.
    pub fn solve(&mut self, (rhs, x): (&Vector, &mut Vector), tolerance: f64, most_iterations: usize) -> Result<Report> {
        if let Some(inverse) = self.inverse.as_mut().filter(|inverse| inverse.exact()) {
            inverse.precondition(self.stokes, rhs, x)?;
            return Ok(Report::default());
        }
        let settings = KrylovSettings { method: KrylovMethod::Gmres { restart: 200 }, tolerance, most_iterations };
        let krylov = Krylov::new(self.stokes.session(), rhs.local()?.len(), c"fluid_", settings)?;
        let mut krylov = krylov.with_remedy(REMEDY);
        krylov.solve(self, (rhs, x), &mut |_, _| {})
    }
}
