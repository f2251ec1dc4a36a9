//! A surface with its modes tabulated at quadrature points: all that bodies of equal shape and size share.

use nalgebra::{DMatrix, SMatrix, SVector};

use super::{Modes, Quadrature, ScalarModes, WithSpinUp, modes, quadrature};

/// The surface of a body: modes, quadrature points, and the tractions of the modes there.
///
/// Surface vectors are stored as `D` numbers a point, scalars as one.
pub struct SurfaceTable<const D: usize> {
    /// The modes, for unit viscosity.
    pub modes: Box<dyn Modes>,
    quadrature: Quadrature,
    /// The quadrature points, from the centre.
    offsets: Vec<SVector<f64, D>>,
    /// Projects values at the points (columns, one a component) on the modes (rows): weight times traction.
    projector: DMatrix<f64>,
    /// First moment of each mode's traction.
    first_moments: Vec<SMatrix<f64, D, D>>,
}

impl<const D: usize> SurfaceTable<D> {
    /// The surface of a ball of the given radius with modes up to `order`, sampled about as finely as the grid.
    pub fn new(radius: f64, order: usize, spacing: f64) -> SurfaceTable<D> {
        SurfaceTable::of(modes(D, radius, order), order, spacing)
    }

    /// As [`new`](Self::new), with the jumps of a body that spins up.
    pub fn with_spin_up(radius: f64, order: usize, spacing: f64) -> SurfaceTable<D> {
        SurfaceTable::of(Box::new(WithSpinUp(modes(D, radius, order))), order, spacing)
    }

    /// As [`new`](Self::new), with the modes of a scalar.
    pub fn scalar(radius: f64, order: usize, spacing: f64) -> SurfaceTable<D> {
        SurfaceTable::of(Box::new(ScalarModes::<D>::new(radius, order)), order, spacing)
    }

    /// The surface that has these modes up to `order`, of a body of any shape, sampled about as finely as the grid.
    pub fn of(modes: Box<dyn Modes>, order: usize, spacing: f64) -> SurfaceTable<D> {
        let quadrature = quadrature(D, modes.radius() / spacing, order);
        let offset = |direction: &[f64]| {
            let mut point = SVector::<f64, D>::zeros();
            modes.point(direction, point.as_mut_slice());
            point
        };
        let offsets = quadrature.directions.chunks(D).map(offset).collect();
        let (count, components) = (modes.count(), modes.components());
        let mut projector = DMatrix::zeros(count, quadrature.weights.len() * components);
        let mut tractions = vec![0.0; count * components];
        for (point, (direction, weight)) in quadrature.directions.chunks(D).zip(&quadrature.weights).enumerate() {
            modes.traction(direction, &mut tractions);
            for (mode, traction) in tractions.chunks(components).enumerate() {
                (0..components).for_each(|i| projector[(mode, point * components + i)] = weight * traction[i]);
            }
        }
        let mut table = SurfaceTable { modes, quadrature, offsets, projector, first_moments: Vec::new() };
        table.first_moments = (0..count).map(|mode| table.integrate_first_moment(mode)).collect();
        table
    }

    /// Number of quadrature points that such a surface has.
    pub fn point_count(radius: f64, order: usize, spacing: f64) -> usize {
        quadrature(D, radius / spacing, order).weights.len()
    }

    /// Number of quadrature points.
    pub fn points(&self) -> usize {
        self.quadrature.weights.len()
    }

    /// The quadrature points, from the centre.
    pub fn offsets(&self) -> impl Iterator<Item = SVector<f64, D>> + '_ {
        self.offsets.iter().copied()
    }

    /// Adds to `out[mode]` the mean over the surface of `traction_mode . values`.
    pub fn project(&self, values: &[f64], out: &mut [f64]) {
        for (value, column) in values.iter().zip(self.projector.as_slice().chunks_exact(self.modes.count())) {
            out.iter_mut().zip(column).for_each(|(out, entry)| *out += value * entry);
        }
    }

    /// The modes' coefficients of a velocity, or of a scalar in the place of its first component, given at each offset from the centre.
    pub fn coefficients(&self, velocity: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        let values: Vec<f64> = self.offsets().flat_map(|offset| velocity(&offset).as_slice()[..self.modes.components()].to_vec()).collect();
        let mut out = vec![0.0; self.modes.count()];
        self.project(&values, &mut out);
        out
    }

    /// The matrix that projects values at the points (columns, one a component) on the modes (rows).
    pub fn projector(&self) -> &DMatrix<f64> {
        &self.projector
    }

    /// Area of the surface (length in 2D).
    pub fn area(&self) -> f64 {
        self.modes.force_factor()
    }

    /// First moment `integral of F_i r_j` of the traction with the given coefficients.
    pub fn first_moment(&self, coefficients: &[f64]) -> SMatrix<f64, D, D> {
        self.first_moments.iter().zip(coefficients).map(|(moment, coefficient)| moment * *coefficient).sum()
    }

    /// The matrix that takes the tangential part of a traction, in coefficients of the modes.
    pub fn tangential(&self) -> DMatrix<f64> {
        let mut along = DMatrix::zeros(self.projector.ncols(), self.modes.count());
        let mut tractions = vec![0.0; self.modes.count() * D];
        for (point, direction) in self.quadrature.directions.chunks(D).enumerate() {
            self.modes.traction(direction, &mut tractions);
            let normal = SVector::<f64, D>::from_column_slice(direction);
            for (mode, traction) in tractions.chunks_exact(D).enumerate() {
                let traction = SVector::<f64, D>::from_column_slice(traction);
                let part = traction - normal * traction.dot(&normal);
                (0..D).for_each(|axis| along[(point * D + axis, mode)] = part[axis]);
            }
        }
        &self.projector * along
    }

    /// First moment of the traction of each mode.
    pub fn first_moments(&self) -> &[SMatrix<f64, D, D>] {
        &self.first_moments
    }

    fn integrate_first_moment(&self, mode: usize) -> SMatrix<f64, D, D> {
        let (points, components) = (self.offsets().enumerate(), self.modes.components());
        let traction = |point: usize| {
            SVector::<f64, D>::from_fn(|i, _| if i < components { self.projector[(mode, point * components + i)] } else { 0.0 })
        };
        let sum: SMatrix<f64, D, D> = points.map(|(point, offset)| traction(point) * offset.transpose()).sum();
        sum * self.area()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_rigid_velocity_has_rigid_coefficients_only() {
        let table = SurfaceTable::<3>::new(0.7, 3, 0.1);
        let (velocity, spin) = (Vector3::new(0.1, -0.4, 0.3), Vector3::new(1.0, 2.0, -0.5));
        let coefficients = table.coefficients(|r| velocity + spin.cross(r));
        let lever = 0.7 * (2.0_f64 / 3.0).sqrt();
        for axis in 0..3 {
            assert!((coefficients[axis] - velocity[axis]).abs() < 1e-14);
            assert!((coefficients[3 + axis] - lever * spin[axis]).abs() < 1e-14);
        }
        assert!(coefficients[6..].iter().all(|coefficient| coefficient.abs() < 1e-14));
    }

    #[test]
    fn the_tangential_part_of_a_traction_is_a_projection() {
        for part in [SurfaceTable::<2>::new(0.7, 5, 0.1).tangential(), SurfaceTable::<3>::new(0.7, 3, 0.1).tangential()] {
            assert!((&part * &part - &part).amax() < 1e-10);
            assert!((&part - part.transpose()).amax() < 1e-10);
            let rank = part.trace();
            assert!((rank - rank.round()).abs() < 1e-9 && rank > 1.0);
        }
    }

    #[test]
    fn the_first_moment_of_a_rotation_is_its_torque() {
        let table = SurfaceTable::<2>::new(0.3, 4, 0.05);
        let mut coefficients = vec![0.0; table.modes.count()];
        coefficients[2] = 1.0;
        let moment = table.first_moment(&coefficients);
        assert!((moment[(1, 0)] - moment[(0, 1)] - table.modes.torque_factor()).abs() < 1e-14);
    }
}
