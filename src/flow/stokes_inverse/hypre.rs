//! The projection form of the Stokes inverse with one BoomerAMG V-cycle for each scalar inverse.
//!
//! With `A^` and `L^` the cycles for `s - Lap` of a velocity component and for `-div grad`,
//!
//! ```text
//! u* = A^ r_u,   d = div u* - r_p,   u = u* + grad L^ d,   p = -d - s L^ d
//! ```
//!
//! which is exact in a periodic box when the cycles are. Fields with the same Laplacian share one set-up.

use std::{ops::Range, rc::Rc, time::Instant};

use super::{Stokes, StokesInverse};
use crate::{
    error::Result,
    grid::Grid,
    petsc::{Amg, AmgSettings, Vector},
};

/// Projection-form inverse with BoomerAMG.
pub struct HypreInverse {
    cycles: Vec<Rc<Amg>>,
    cycle_of: Vec<usize>,
    fields: Vec<(Range<usize>, f64)>,
    /// Work vectors, one a field.
    given: Vec<Vector>,
    found: Vec<Vector>,
    shift: f64,
    fully_periodic: bool,
    setup_seconds: f64,
}

impl HypreInverse {
    /// Sets up one hierarchy for each Laplacian that differs; that of the pressure is the same for all shifts.
    pub fn new<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>) -> Result<HypreInverse> {
        let start = Instant::now();
        let settings = AmgSettings::laplacian(D);
        let (laplacians, cycle_of) = stokes.laplacians()?;
        let fully_periodic = grid.domain().fully_periodic();
        let singular = fully_periodic && stokes.shift() == 0.0;
        let cycles = laplacians.iter().enumerate().map(|(index, matrix)| match cycle_of[D] == index {
            true => stokes.pressure_cycle(),
            false => Amg::new(matrix, singular, &settings).map(Rc::new),
        });
        Ok(HypreInverse {
            cycles: cycles.collect::<Result<_>>()?,
            cycle_of: cycle_of.to_vec(),
            fields: stokes.balanced_fields(),
            given: (0..=D).map(|field| stokes.field_vector(field)).collect::<Result<_>>()?,
            found: (0..=D).map(|field| stokes.field_vector(field)).collect::<Result<_>>()?,
            shift: stokes.shift(),
            fully_periodic,
            setup_seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Seconds spent setting it up.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }

    fn cycle(&mut self, field: usize) -> Result<()> {
        self.cycles[self.cycle_of[field]].apply(&self.given[field], &mut self.found[field])
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

impl<const D: usize> StokesInverse<D> for HypreInverse {
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()> {
        self.take(rows)?;
        self.given[D].scale(-1.0)?;
        for axis in 0..D {
            self.cycle(axis)?;
            stokes.divergence(axis)?.multiply_add(&self.found[axis], &mut self.given[D])?;
        }
        self.cycle(D)?;
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
