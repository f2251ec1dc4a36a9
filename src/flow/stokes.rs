//! The Stokes operator of the box, `K (u, p) = (-Lap u + grad p, div u)`, on the staggered grid.

use crate::{
    error::Result,
    grid::{Grid, operators},
    petsc::{Matrix, Session, Vector},
};

/// The Stokes operator and its parts.
///
/// It acts on fluid vectors. Residuals and right-hand sides have *balanced rows*: momentum rows times `h^2` and continuity rows
/// times `h`, so that every row is a velocity and one residual norm weighs all; the components in its null space
/// (mean divergence; in a fully periodic box also mean momentum) are projected out.
pub struct Stokes<const D: usize> {
    session: Session,
    /// Minus the Laplacians that differ, and which one each field has.
    laplacians: Vec<Matrix>,
    laplacian_of: Vec<usize>,
    gradient: Vec<Matrix>,
    divergence: Vec<Matrix>,
    nest: Matrix,
    balance: Balance,
}

/// Scaling of rows and projection on the range.
#[derive(Clone)]
struct Balance {
    /// For each field: its range in this rank's part of a fluid vector, the factor of its rows, its unknowns on all
    /// ranks, whether its mean is projected out.
    fields: Vec<(std::ops::Range<usize>, f64, usize, bool)>,
}

impl<const D: usize> Stokes<D> {
    /// Assembles the operator of a box.
    pub fn new(session: &Session, grid: &Grid<D>) -> Result<Stokes<D>> {
        let mut laplacians: Vec<(usize, Matrix)> = Vec::new();
        let mut laplacian_of = Vec::new();
        for field in 0..=D {
            let shared = laplacians.iter().position(|&(other, _)| grid.same_laplacian(field, other));
            if shared.is_none() {
                laplacians.push((field, operators::minus_laplacian(session, grid, field)?));
            }
            laplacian_of.push(shared.unwrap_or(laplacians.len() - 1));
        }
        let laplacians: Vec<Matrix> = laplacians.into_iter().map(|(_, matrix)| matrix).collect();
        let gradient = (0..D).map(|axis| operators::gradient(session, grid, axis)).collect::<Result<Vec<_>>>()?;
        let divergence = (0..D).map(|axis| operators::divergence(session, grid, axis)).collect::<Result<Vec<_>>>()?;
        let nest = nest(session, |axis| &laplacians[laplacian_of[axis]], &gradient, &divergence)?;
        Ok(Stokes { session: session.clone(), laplacians, laplacian_of, gradient, divergence, nest, balance: Balance::new(grid) })
    }

    /// The session it lives in.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Minus the Laplacians that differ, and which one each field has.
    pub fn laplacians(&self) -> (&[Matrix], &[usize]) {
        (&self.laplacians, &self.laplacian_of)
    }

    /// The gradient along an axis.
    pub fn gradient(&self, axis: usize) -> &Matrix {
        &self.gradient[axis]
    }

    /// The part of the divergence along an axis.
    pub fn divergence(&self, axis: usize) -> &Matrix {
        &self.divergence[axis]
    }

    /// `output = K input`, rows not balanced.
    pub fn multiply(&self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.nest.multiply(input, output)
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
    pub fn balanced_fields(&self) -> Vec<(std::ops::Range<usize>, f64)> {
        self.balance.fields.iter().map(|(range, factor, ..)| (range.clone(), *factor)).collect()
    }

    /// A fluid vector of zeros.
    pub fn vector(&self) -> Result<Vector> {
        Vector::new(&self.session, self.balance.fields.iter().map(|(range, ..)| range.len()).sum())
    }

    /// A vector of zeros for one field.
    pub fn field_vector(&self, field: usize) -> Result<Vector> {
        Vector::new(&self.session, self.balance.fields[field].0.len())
    }
}

fn nest<'a>(
    session: &Session,
    laplacian: impl Fn(usize) -> &'a Matrix,
    gradient: &'a [Matrix],
    divergence: &'a [Matrix],
) -> Result<Matrix> {
    let axes = gradient.len();
    let mut blocks: Vec<Vec<Option<&Matrix>>> = vec![vec![None; axes + 1]; axes + 1];
    for axis in 0..axes {
        blocks[axis][axis] = Some(laplacian(axis));
        blocks[axis][axes] = Some(&gradient[axis]);
        blocks[axes][axis] = Some(&divergence[axis]);
    }
    Matrix::nest(session, &blocks)
}

impl Balance {
    fn new<const D: usize>(grid: &Grid<D>) -> Balance {
        let h = grid.mean_spacing();
        let field = |field: usize| {
            let factor = if field == D { h } else { h * h };
            (grid.local_range(field), factor, grid.unknowns(field), field == D || grid.domain().fully_periodic())
        };
        Balance { fields: (0..=D).map(field).collect() }
    }

    fn scale(&self, rows: &mut Vector) -> Result<()> {
        let mut rows = rows.local_mut()?;
        for (range, factor, ..) in &self.fields {
            rows[range.clone()].iter_mut().for_each(|row| *row *= factor);
        }
        Ok(())
    }

    fn project(&self, session: &Session, rows: &mut Vector) -> Result<()> {
        let mut rows = rows.local_mut()?;
        let mean = |(range, _, unknowns, _): &(std::ops::Range<usize>, f64, usize, bool)| {
            rows[range.clone()].iter().sum::<f64>() / *unknowns as f64
        };
        let mut means: Vec<f64> = self.fields.iter().map(mean).collect();
        session.world().sum(&mut means);
        for ((range, _, _, projected), mean) in self.fields.iter().zip(means) {
            if *projected {
                rows[range.clone()].iter_mut().for_each(|row| *row -= mean);
            }
        }
        Ok(())
    }
}
