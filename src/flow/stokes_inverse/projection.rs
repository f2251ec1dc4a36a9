//! The projection form of the Stokes inverse, with an inverse of each scalar block.
//!
//! With `A^` and `L^` those of `s - Lap` of a velocity component and of `-div grad`,
//!
//! ```text
//! u* = A^ r_u,   d = div u* - r_p,   u = u* + grad L^ d,   p = -d - s L^ d
//! ```
//!
//! which is exact in a periodic box when they are. Between walls it is not: what it leaves is near them.

use std::ops::Range;

use super::{Stokes, StokesInverse};
use crate::{error::Result, grid::Grid, parallel::World, petsc::Vector};

/// Inverses, approximate or exact, of the shifted Laplacians of all fields.
pub trait FieldInverse {
    /// `found = A^ given` of a field; that of a field which may be any constant has no mean. Collective.
    fn apply(&mut self, world: &World, field: usize, given: &Vector, found: &mut Vector) -> Result<()>;
}

/// The projection form.
pub struct ProjectionInverse {
    inverses: Box<dyn FieldInverse>,
    fields: Vec<(Range<usize>, f64)>,
    /// Work vectors, one a field.
    given: Vec<Vector>,
    found: Vec<Vector>,
    shift: f64,
    fully_periodic: bool,
}

impl ProjectionInverse {
    /// That of inverses of fields.
    ///
    /// # Errors
    /// PETSc has no memory for it.
    pub fn new<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>, inverses: Box<dyn FieldInverse>) -> Result<ProjectionInverse> {
        Ok(ProjectionInverse {
            inverses,
            fields: stokes.balanced_fields(),
            given: (0..=D).map(|field| stokes.field_vector(field)).collect::<Result<_>>()?,
            found: (0..=D).map(|field| stokes.field_vector(field)).collect::<Result<_>>()?,
            shift: stokes.shift(),
            fully_periodic: grid.domain().fully_periodic(),
        })
    }

    fn invert(&mut self, world: &World, field: usize) -> Result<()> {
        self.inverses.apply(world, field, &self.given[field], &mut self.found[field])
    }

    /// Takes the rows of each field out of a fluid vector, no longer balanced.
    fn take(&mut self, rows: &Vector) -> Result<()> {
        let rows = rows.local()?;
        for ((range, factor), given) in self.fields.iter().zip(&mut self.given) {
            let mut given = given.local_mut()?;
            given.iter_mut().zip(&rows[range.clone()]).for_each(|(given, row)| *given = row / factor);
        }
        Ok(())
    }

    fn put(&self, output: &mut Vector) -> Result<()> {
        let mut output = output.local_mut()?;
        for ((range, _), found) in self.fields.iter().zip(&self.found) {
            output[range.clone()].copy_from_slice(&found.local()?);
        }
        Ok(())
    }
}

impl<const D: usize> StokesInverse<D> for ProjectionInverse {
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()> {
        let world = stokes.session().world();
        self.take(rows)?;
        self.given[D].scale(-1.0)?;
        for axis in 0..D {
            self.invert(world, axis)?;
            stokes.divergence(axis)?.multiply_add(&self.found[axis], &mut self.given[D])?;
        }
        self.invert(world, D)?;
        let (velocities, pressure) = self.found.split_at_mut(D);
        for (axis, velocity) in velocities.iter_mut().enumerate() {
            stokes.gradient(axis)?.multiply_add(&pressure[0], velocity)?;
        }
        pressure[0].scale(-self.shift)?;
        pressure[0].add(-1.0, &self.given[D])?;
        pressure[0].remove_mean()?;
        if self.fully_periodic && self.shift > 0.0 {
            velocities.iter_mut().try_for_each(Vector::remove_mean)?;
        }
        self.put(output)
    }
}
