//! How well conditioned a linear system is, from its matrix: one application for each unknown, for studies of few unknowns.

use nalgebra::DMatrix;

use crate::{
    error::Result,
    parallel::World,
    petsc::{System, Vector},
};

/// Condition numbers, largest over smallest singular value, of the system on the multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Unknowns.
    pub unknowns: usize,
    /// As it is.
    pub plain: f64,
    /// With the preconditioner that the solver uses, from the right.
    pub preconditioned: f64,
}

impl Conditions {
    /// Those of a system whose vectors are like `shape`.
    pub fn of(world: &World, system: &mut dyn System, shape: &Vector) -> Result<Conditions> {
        let plain = matrix(world, shape, |unit, column| system.apply(unit, column))?;
        let mut between = shape.like()?;
        let preconditioned = matrix(world, shape, |unit, column| {
            system.precondition(unit, &mut between)?;
            system.apply(&between, column)
        })?;
        Ok(Conditions { unknowns: plain.ncols(), plain: condition(plain), preconditioned: condition(preconditioned) })
    }
}

/// The dense matrix of a linear map, on all ranks.
fn matrix(world: &World, shape: &Vector, mut map: impl FnMut(&Vector, &mut Vector) -> Result<()>) -> Result<DMatrix<f64>> {
    let (mut unit, mut column, own) = (shape.like()?, shape.like()?, shape.range()?);
    let mut size = [own.len() as f64];
    world.sum(&mut size);
    let size = size[0] as usize;
    let mut matrix = DMatrix::zeros(size, size);
    for place in 0..size {
        unit.fill(0.0)?;
        if own.contains(&place) {
            unit.local_mut()?[place - own.start] = 1.0;
        }
        map(&unit, &mut column)?;
        matrix.column_mut(place).as_mut_slice()[own.clone()].copy_from_slice(&column.local()?);
    }
    world.sum(matrix.as_mut_slice());
    Ok(matrix)
}

/// Singular values that are rounding noise beside the largest: directions that no row sees, and no right-hand side excites.
const UNSEEN: f64 = 1e-13;

fn condition(matrix: DMatrix<f64>) -> f64 {
    let values = matrix.singular_values();
    let largest = values.max();
    largest / values.iter().copied().filter(|value| *value > UNSEEN * largest).fold(largest, f64::min)
}
