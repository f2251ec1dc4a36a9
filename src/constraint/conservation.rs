//! Momentum that the corrected stencils of a body exert: exactly that of its tractions.
//!
//! Summed over the grid, corrected stencils have the net force and the first moment of the traction only up to the
//! truncation error. That spurious force, times its distance to a wall, would be a wrong stress there, and its scatter
//! with the position of the body on the grid would be noise in every result. The smallest correction of the rows that is
//! linear in space gives them both moments exactly:
//!
//! ```text
//! sum_rows h^D C = integral of F        sum_rows h^D C r^T = integral of F r^T
//! ```
//!
//! Within a cell of a wall part of both passes to the wall, whose points have no rows. What these would be is known from the stencils
//! ([`wall_row`](crate::grid::stencil::wall_row)) and left out of the sums: to press it into the rows there are makes the resistance of a film much thinner than a
//! cell 25 % too small, and better only with the root of the spacing.

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut, SVector};

use crate::surface::SurfaceTable;

/// Force and first moments, filled up with zeros: products of matrices are fast from this size on.
pub const TERMS: usize = 6;

/// Rows at offsets from the centre, with one value a mode for each.
pub struct AtOffsets<'a, const D: usize, V> {
    /// The offsets.
    pub offsets: &'a [SVector<f64, D>],
    /// The values, modes running fastest.
    pub values: V,
}

/// What the rows of one component have to add up to.
pub struct Wanted<'a, const D: usize> {
    /// The surface whose tractions the rows stand for.
    pub surface: &'a SurfaceTable<D>,
    /// The component.
    pub component: usize,
    /// Sums, and sums times offsets over the radius, of the values of sources, which come behind those of the modes.
    pub sources: &'a [[f64; TERMS]],
    /// Volume of a cell.
    pub cell_volume: f64,
}

/// Corrects the rows of one component, which have all but what has `passed` to walls.
pub fn conserve_momentum<const D: usize>(wanted: &Wanted<D>, passed: AtOffsets<D, &[f64]>, rows: AtOffsets<D, &mut [f64]>) {
    let radius = wanted.surface.modes.radius();
    let mut missing = wanted.moments();
    subtract_moments(radius, passed, &mut missing);
    conserve(radius, missing, rows);
}

/// One over offsets, offsets over `length`, and zeros, in turn.
fn basis<const D: usize>(length: f64, offsets: &[SVector<f64, D>]) -> DMatrix<f64> {
    DMatrix::from_fn(TERMS, offsets.len(), |term, row| match term {
        0 => 1.0,
        term if term <= D => offsets[row][term - 1] / length,
        _ => 0.0,
    })
}

fn subtract_moments<const D: usize>(length: f64, AtOffsets { offsets, values }: AtOffsets<D, &[f64]>, moments: &mut DMatrix<f64>) {
    moments.gemm(-1.0, &DMatrixView::from_slice(values, moments.nrows(), offsets.len()), &basis(length, offsets).transpose(), 1.0);
}

/// Gives rows the missing sums, and sums times offsets over `length` (one row a mode, filled up with zeros to [`TERMS`]).
fn conserve<const D: usize>(length: f64, mut missing: DMatrix<f64>, AtOffsets { offsets, values }: AtOffsets<D, &mut [f64]>) {
    let (count, rows) = (missing.nrows(), offsets.len());
    let basis = basis(length, offsets);
    subtract_moments(length, AtOffsets { offsets, values: &*values }, &mut missing);
    let moments = basis.rows(0, D + 1);
    // rows too few or in line cannot carry all moments: such a body lies almost wholly beyond what the grid resolves
    if let Some(inverse) = (moments * moments.transpose()).try_inverse() {
        let mut factors = DMatrix::zeros(count, TERMS);
        missing.columns(0, D + 1).mul_to(&inverse, &mut factors.columns_mut(0, D + 1));
        DMatrixViewMut::from_slice(values, count, rows).gemm(1.0, &factors, &basis, 1.0);
    }
}

impl<const D: usize> Wanted<'_, D> {
    /// Over the volume of a cell, net force and first moments over the radius of each mode's traction (modes down, moments across, then
    /// zeros), and behind the modes those of sources.
    fn moments(&self) -> DMatrix<f64> {
        let (moments, component) = (self.surface.first_moments(), self.component);
        DMatrix::from_fn(moments.len() + self.sources.len(), TERMS, |mode, term| match term {
            _ if mode >= moments.len() => self.sources[mode - moments.len()][term],
            0 if mode == component => self.surface.area() / self.cell_volume,
            0 => 0.0,
            term if term > D => 0.0,
            _ => moments[mode][(component, term - 1)] / self.surface.modes.radius() / self.cell_volume,
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn corrected_rows_have_the_force_and_first_moment_of_the_traction() {
        let surface = SurfaceTable::<2>::new(0.5, 4, 0.1);
        let offsets: Vec<_> = (0..40).map(|row| Vector2::new((row as f64).sin(), (1.7 * row as f64).cos()) * 0.5).collect();
        let count = surface.modes.count();
        let mut values: Vec<f64> = (0..40 * count).map(|place| (place as f64).sin()).collect();
        let wanted = Wanted { surface: &surface, component: 1, sources: &[], cell_volume: 0.01 };
        let none = AtOffsets { offsets: &[], values: &[][..] };
        conserve_momentum(&wanted, none, AtOffsets { offsets: &offsets, values: &mut values[..] });
        for mode in 0..count {
            let sum = |weight: &dyn Fn(&Vector2<f64>) -> f64| -> f64 {
                offsets.iter().enumerate().map(|(row, offset)| 0.01 * weight(offset) * values[row * count + mode]).sum()
            };
            assert!((sum(&|_| 1.0) - if mode == 1 { surface.area() } else { 0.0 }).abs() < 1e-12);
            assert!((sum(&|r| r[0]) - surface.first_moments()[mode][(1, 0)]).abs() < 1e-12);
            assert!((sum(&|r| r[1]) - surface.first_moments()[mode][(1, 1)]).abs() < 1e-12);
        }
    }
}
