//! The Stokes operator of the box, `K (u, p) = (s u - Lap u + grad p, div u)`, on the staggered grid; the shift `s` is 0 but where the flow has
//! inertia.

use std::{cell::OnceCell, ops::Range, rc::Rc};

use super::stokes_matrices::{Matrices, Unshifted};
use crate::{
    error::Result,
    grid::Grid,
    petsc::{Amg, AmgSettings, Matrix, Session, Vector},
};

/// The Stokes operator and its parts.
///
/// It acts on fluid vectors. Residuals and right-hand sides have *balanced rows*: momentum rows times `h^2 / (1 + s h^2 / 2D)` and continuity rows
/// times `h`, so that every row is a velocity and one residual norm weighs all; the components in its null space
/// (mean divergence; in a fully periodic box also mean momentum) are projected out.
///
/// Its matrices are assembled when they are first asked for: an exact inverse needs none.
pub struct Stokes<const D: usize> {
    session: Session,
    grid: Grid<D>,
    shift: f64,
    /// Those that no shift changes, which operators with other ones have too.
    unshifted: Rc<OnceCell<Unshifted>>,
    matrices: OnceCell<Matrices>,
    balance: Balance,
}

/// Scaling of rows and projection on the range.
#[derive(Clone)]
struct Balance {
    fields: Vec<FieldRows>,
}

/// The rows of one field.
#[derive(Clone)]
struct FieldRows {
    /// In this rank's part of a fluid vector.
    range: Range<usize>,
    factor: f64,
    /// On all ranks.
    unknowns: usize,
    /// Whether the mean is projected out.
    projected: bool,
}

impl<const D: usize> Stokes<D> {
    /// The operator of a box without inertia.
    pub fn new(session: &Session, grid: &Grid<D>) -> Stokes<D> {
        Stokes::shifted(session, grid, 0.0)
    }

    /// The operator of a step of a flow with inertia: `shift` is the density times what the new velocity weighs in its rate of change (one over
    /// time), over the viscosity.
    pub fn shifted(session: &Session, grid: &Grid<D>, shift: f64) -> Stokes<D> {
        let (matrices, unshifted) = (OnceCell::new(), Rc::default());
        Stokes { session: session.clone(), grid: grid.clone(), shift, unshifted, matrices, balance: Balance::new(grid, shift) }
    }

    /// The operator of the same grid with another shift, which shares what does not depend on it.
    pub fn with_shift(&self, shift: f64) -> Stokes<D> {
        Stokes { unshifted: self.unshifted.clone(), ..Stokes::shifted(&self.session, &self.grid, shift) }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// What is added to minus the Laplacians of velocities, one over the square of a length.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// The session it lives in.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Minus the Laplacians that differ, shifted for velocities, and which one each field has.
    pub fn laplacians(&self) -> Result<(&[Rc<Matrix>], &[usize])> {
        let matrices = self.matrices()?;
        Ok((&matrices.laplacians, &matrices.laplacian_of))
    }

    /// A multigrid cycle for the pressure's, set up once for operators of all shifts.
    pub fn pressure_cycle(&self) -> Result<Rc<Amg>> {
        let unshifted = self.unshifted()?;
        match unshifted.cycle.get() {
            Some(cycle) => Ok(cycle.clone()),
            None => {
                let cycle = Rc::new(Amg::new(&unshifted.laplacian, true, &AmgSettings::laplacian(D))?);
                Ok(unshifted.cycle.get_or_init(|| cycle).clone())
            }
        }
    }

    /// The gradient along an axis.
    pub fn gradient(&self, axis: usize) -> Result<&Matrix> {
        Ok(&self.unshifted()?.gradient[axis])
    }

    /// The part of the divergence along an axis.
    pub fn divergence(&self, axis: usize) -> Result<&Matrix> {
        Ok(&self.unshifted()?.divergence[axis])
    }

    /// `output = K input`, rows not balanced.
    pub fn multiply(&self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.matrices()?.nest.multiply(input, output)
    }

    fn matrices(&self) -> Result<&Matrices> {
        match self.matrices.get() {
            Some(matrices) => Ok(matrices),
            None => {
                let matrices = Matrices::new(&self.session, &self.grid, self.shift, self.unshifted()?)?;
                Ok(self.matrices.get_or_init(|| matrices))
            }
        }
    }

    fn unshifted(&self) -> Result<&Unshifted> {
        match self.unshifted.get() {
            Some(unshifted) => Ok(unshifted),
            None => {
                let unshifted = Unshifted::new(&self.session, &self.grid)?;
                Ok(self.unshifted.get_or_init(|| unshifted))
            }
        }
    }

    /// Balances the rows of a right-hand side or residual.
    pub fn balance(&self, rows: &mut Vector) -> Result<()> {
        self.balance.scale(rows)?;
        self.project(rows)
    }

    /// Projects balanced rows on the range of the operator.
    pub fn project(&self, rows: &mut Vector) -> Result<()> {
        self.balance.project(&self.session, rows)
    }

    /// For each field: its range in this rank's part of a fluid vector and the factor of its balanced rows.
    pub fn balanced_fields(&self) -> Vec<(Range<usize>, f64)> {
        self.balance.fields.iter().map(|rows| (rows.range.clone(), rows.factor)).collect()
    }

    /// A fluid vector of zeros.
    pub fn vector(&self) -> Result<Vector> {
        Vector::new(&self.session, self.balance.fields.iter().map(|rows| rows.range.len()).sum())
    }

    /// A vector of zeros for one field.
    pub fn field_vector(&self, field: usize) -> Result<Vector> {
        Vector::new(&self.session, self.balance.fields[field].range.len())
    }
}

impl Balance {
    fn new<const D: usize>(grid: &Grid<D>, shift: f64) -> Balance {
        let h = grid.mean_spacing();
        let momentum = h * h / (1.0 + shift * h * h / (2.0 * D as f64));
        let rows = |field: usize| FieldRows {
            range: grid.local_range(field),
            factor: if field == D { h } else { momentum },
            unknowns: grid.unknowns(field),
            projected: field == D || grid.domain().fully_periodic(),
        };
        Balance { fields: (0..=D).map(rows).collect() }
    }

    fn scale(&self, rows: &mut Vector) -> Result<()> {
        let mut values = rows.local_mut()?;
        for FieldRows { range, factor, .. } in &self.fields {
            values[range.clone()].iter_mut().for_each(|value| *value *= factor);
        }
        Ok(())
    }

    fn project(&self, session: &Session, rows: &mut Vector) -> Result<()> {
        let mut values = rows.local_mut()?;
        let mean = |rows: &FieldRows| values[rows.range.clone()].iter().sum::<f64>() / rows.unknowns as f64;
        let mut means: Vec<f64> = self.fields.iter().map(mean).collect();
        session.world().sum(&mut means);
        for (rows, mean) in self.fields.iter().zip(means).filter(|(rows, _)| rows.projected) {
            values[rows.range.clone()].iter_mut().for_each(|value| *value -= mean);
        }
        Ok(())
    }
}
