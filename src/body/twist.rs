//! Rigid motions in any dimension.

use nalgebra::{SMatrix, SVector};

/// Spin component `k` (about axis `k`) is this entry of the skew matrix.
const PLANES: [(usize, usize); 3] = [(2, 1), (0, 2), (1, 0)];

/// The planes of rotation of a dimension: one in 2D, three in 3D (in the order of the axes x, y, z).
pub fn planes<const D: usize>() -> &'static [(usize, usize)] {
    if D == 2 { &PLANES[2..] } else { &PLANES }
}

/// A rigid velocity: `velocity + spin * r` at distance `r` from the centre, with a skew `spin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist<const D: usize> {
    /// Velocity of the centre.
    pub velocity: SVector<f64, D>,
    /// Skew matrix of the rotation.
    pub spin: SMatrix<f64, D, D>,
}

impl<const D: usize> Twist<D> {
    /// No motion.
    pub fn zero() -> Self {
        Twist { velocity: SVector::zeros(), spin: SMatrix::zeros() }
    }

    /// The velocity at distance `r` from the centre.
    pub fn at(&self, r: &SVector<f64, D>) -> SVector<f64, D> {
        self.velocity + self.spin * r
    }
}

/// The skew matrix with the given components (one in 2D, three in 3D).
pub fn skew<const D: usize>(components: &[f64]) -> SMatrix<f64, D, D> {
    let mut matrix = SMatrix::zeros();
    for (&(row, column), &value) in planes::<D>().iter().zip(components) {
        matrix[(row, column)] = value;
        matrix[(column, row)] = -value;
    }
    matrix
}

/// The components of a skew matrix (one in 2D, three in 3D).
pub fn components<const D: usize>(skew: &SMatrix<f64, D, D>) -> Vec<f64> {
    planes::<D>().iter().map(|&plane| skew[plane]).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;

    #[test]
    fn a_spin_in_3d_is_the_cross_product() {
        let (spin, r) = (Vector3::new(0.3, -0.5, 0.7), Vector3::new(1.0, 2.0, -1.5));
        let twist = Twist::<3> { velocity: Vector3::zeros(), spin: skew(spin.as_slice()) };
        assert!((twist.at(&r) - spin.cross(&r)).norm() < 1e-15);
        assert_eq!(components(&twist.spin), spin.as_slice());
    }

    #[test]
    fn a_positive_spin_in_2d_turns_counter_clockwise() {
        let twist = Twist::<2> { velocity: Vector2::zeros(), spin: skew(&[2.0]) };
        assert_eq!(twist.at(&Vector2::x()), Vector2::new(0.0, 2.0));
    }
}
