//! A sparse linear system that each rank assembles a part of.

use std::ops::Range;

use crate::{
    error::{Error, Result},
    parallel::World,
    petsc::{Direct, Matrix, RowBuilder, Session, Vector},
};

/// Residual, relative to the right-hand side, above which the answer of a direct solver is not trusted.
const LARGEST_RESIDUAL: f64 = 1e-7;

/// The rows of this rank, and their right-hand sides.
pub struct System {
    range: Range<usize>,
    /// Columns and values, which add up where columns repeat.
    rows: Vec<Vec<(usize, f64)>>,
    loads: Vec<f64>,
    /// What one of each unknown, of all ranks, stands for; nothing if that is one.
    units: Option<Vec<f64>>,
}

impl System {
    /// A system of so many unknowns, shared out evenly, without entries.
    pub fn new(world: &World, unknowns: usize) -> System {
        let start = |rank: usize| rank * unknowns / world.size();
        let range = start(world.rank())..start(world.rank() + 1);
        System { rows: vec![Vec::new(); range.len()], loads: vec![0.0; range.len()], range, units: None }
    }

    /// The same in units of its own: the solver sees each unknown over its unit, and each row times that of its unknown.
    pub fn in_units(self, units: Vec<f64>) -> System {
        System { units: Some(units), ..self }
    }

    /// Whether a row is one of this rank's.
    pub fn holds(&self, row: usize) -> bool {
        self.range.contains(&row)
    }

    /// Adds to an entry, if its row is one of this rank's.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        if self.holds(row) {
            self.rows[row - self.range.start].push((column, value));
        }
    }

    /// Adds to a right-hand side, if its row is one of this rank's.
    pub fn load(&mut self, row: usize, value: f64) {
        if self.holds(row) {
            self.loads[row - self.range.start] += value;
        }
    }

    /// Solves, with the factors of an earlier system of the same structure if they are at hand; returns all unknowns on every rank,
    /// and the relative residual.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the matrix is singular.
    pub fn solve(self, session: &Session, direct: &mut Option<Direct>) -> Result<(Vec<f64>, f64)> {
        let (local, first) = (self.range.len(), self.range.start);
        let unit = |unknown: usize| self.units.as_ref().map_or(1.0, |units| units[unknown]);
        let mut rows = RowBuilder::default();
        for (row, entries) in self.rows.iter().enumerate() {
            let factor = unit(first + row);
            entries.iter().for_each(|&(column, value)| rows.push(column, value * factor * unit(column)));
            rows.end_row();
        }
        let mut solver = match direct.take() {
            None => Direct::new(Matrix::from_rows(session, local, rows)?)?,
            Some(mut solver) => {
                solver.replace(rows)?;
                solver
            }
        };
        let mut rhs = Vector::new(session, local)?;
        rhs.local_mut()?.iter_mut().zip(&self.loads).enumerate().for_each(|(row, (rhs, load))| *rhs = load * unit(first + row));
        let mut x = rhs.like()?;
        let residual = solver.solve(&rhs, &mut x)?;
        if residual > LARGEST_RESIDUAL || residual.is_nan() {
            return Err(Error::Diverged(format!(
                "the direct solver leaves a residual of {residual:.1e}: the system is nearly singular; another resolution.spacing may help"
            )));
        }
        let mut all = session.world().gather(&x.local()?);
        all.iter_mut().enumerate().for_each(|(unknown, value)| *value *= unit(unknown));
        *direct = Some(solver);
        Ok((all, residual))
    }
}
