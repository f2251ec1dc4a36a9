//! The blocks of one and of two bodies in unbounded fluid, in the frame of the pair.

use nalgebra::{DMatrix, SVector};

use crate::surface::SurfaceTable;

/// Quadrature points lie about a radius over this number apart.
const FINENESS: f64 = 10.0;

/// A body of a pair.
pub struct Side<const D: usize> {
    /// Its surface.
    pub surface: SurfaceTable<D>,
}

impl<const D: usize> Side<D> {
    /// A body of the given radius, with modes up to `order`.
    pub fn new(radius: f64, order: usize) -> Side<D> {
        Side { surface: SurfaceTable::new(radius, order, radius / FINENESS) }
    }

    /// Its block when it is alone: the rows of rigid modes are those modes times the radius.
    pub fn isolated(&self) -> DMatrix<f64> {
        let modes = &self.surface.modes;
        let mut block = modes.isolated_mobility(modes.radius());
        for mode in 0..modes.rigid_count() {
            block[(mode, mode)] = modes.radius();
        }
        block
    }

    /// The velocity that unit multipliers of `other` cause at this body's points, `D` rows a point; in 2D up to a uniform one.
    ///
    /// Each of the two sees the other along the axis of its own frame: the frames differ by half a turn.
    pub fn velocity_caused_by(&self, other: &Side<D>, distance: f64) -> DMatrix<f64> {
        let (axis, signs) = if D == 2 { (0, [-1.0, -1.0, 1.0]) } else { (2, [-1.0, 1.0, -1.0]) };
        let mut center = SVector::<f64, D>::zeros();
        center[axis] = distance;
        let count = other.surface.modes.count();
        let mut values = vec![0.0; count * D];
        let mut velocity = DMatrix::zeros(self.surface.points() * D, count);
        for (point, offset) in self.surface.offsets().enumerate() {
            let from_other = SVector::<f64, D>::from_fn(|i, _| signs[i] * (offset[i] - center[i]));
            other.surface.modes.exterior_velocity(from_other.as_slice(), distance, &mut values);
            for (mode, value) in values.chunks_exact(D).enumerate() {
                (0..D).for_each(|i| velocity[(point * D + i, mode)] = signs[i] * value[i]);
            }
        }
        velocity
    }

    /// The `velocity` of given `columns` tested with the modes `rows`, but not with rigid ones.
    pub fn test(&self, velocity: &DMatrix<f64>, rows: &[usize], columns: &[usize]) -> DMatrix<f64> {
        let mut block = self.surface.projector().select_rows(rows) * velocity.select_columns(columns);
        for (row, _) in rows.iter().enumerate().filter(|&(_, &mode)| mode < self.surface.modes.rigid_count()) {
            block.row_mut(row).fill(0.0);
        }
        block
    }
}
