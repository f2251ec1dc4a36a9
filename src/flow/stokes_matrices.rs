//! The matrices of the Stokes operator.

use std::{cell::OnceCell, rc::Rc};

use crate::{
    error::Result,
    grid::{Grid, operators},
    petsc::{Amg, Matrix, Session},
};

/// What does not depend on the shift.
pub struct Unshifted {
    /// Minus the Laplacian of the pressure.
    pub laplacian: Rc<Matrix>,
    /// Its multigrid cycle, once it is asked for.
    pub cycle: OnceCell<Rc<Amg>>,
    /// The gradient along each axis.
    pub gradient: Vec<Matrix>,
    /// The part of the divergence along each axis.
    pub divergence: Vec<Matrix>,
}

/// The operator's parts.
pub struct Matrices {
    /// Minus the Laplacians that differ, shifted for velocities, and which one each field has.
    pub laplacians: Vec<Rc<Matrix>>,
    /// The Laplacian of each field.
    pub laplacian_of: Vec<usize>,
    /// The whole operator.
    pub nest: Matrix,
}

impl Unshifted {
    /// Assembles all but the cycle. Collective.
    pub fn new<const D: usize>(session: &Session, grid: &Grid<D>) -> Result<Unshifted> {
        Ok(Unshifted {
            laplacian: Rc::new(operators::shifted_laplacian(session, grid, D, 0.0)?),
            cycle: OnceCell::new(),
            gradient: (0..D).map(|axis| operators::gradient(session, grid, axis)).collect::<Result<_>>()?,
            divergence: (0..D).map(|axis| operators::divergence(session, grid, axis)).collect::<Result<_>>()?,
        })
    }
}

impl Matrices {
    /// Assembles those of a shift. Collective.
    pub fn new<const D: usize>(session: &Session, grid: &Grid<D>, shift: f64, unshifted: &Unshifted) -> Result<Matrices> {
        let mut laplacians: Vec<(usize, Rc<Matrix>)> = Vec::new();
        let mut laplacian_of = Vec::new();
        let shift_of = |field: usize| if field < D { shift } else { 0.0 };
        let alike = |field: usize, other: usize| grid.same_laplacian(field, other) && shift_of(field) == shift_of(other);
        for field in 0..=D {
            let shared = laplacians.iter().position(|&(other, _)| alike(field, other));
            if shared.is_none() {
                let of_pressure = alike(field, D).then(|| unshifted.laplacian.clone());
                let own = || operators::shifted_laplacian(session, grid, field, shift_of(field)).map(Rc::new);
                laplacians.push((field, of_pressure.map_or_else(own, Ok)?));
            }
            laplacian_of.push(shared.unwrap_or(laplacians.len() - 1));
        }
        let laplacians: Vec<Rc<Matrix>> = laplacians.into_iter().map(|(_, matrix)| matrix).collect();
        let nest = nest(session, |axis| &laplacians[laplacian_of[axis]], &unshifted.gradient, &unshifted.divergence)?;
        Ok(Matrices { laplacians, laplacian_of, nest })
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
