//! The ball: a disk in 2D, a sphere in 3D.

use std::f64::consts::PI;

use nalgebra::SVector;

/// A disk (2D) or a sphere (3D).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<const D: usize> {
    /// Position of the centre.
    pub center: SVector<f64, D>,
    /// Distance from the centre to the surface.
    pub radius: f64,
}

impl<const D: usize> Ball<D> {
    /// Volume of the ball (area in 2D), `V_D = 2 pi r^2 V_{D-2} / D` with `V_0 = 1` and `V_1 = 2 r`.
    pub fn volume(&self) -> f64 {
        let lowest = if D.is_multiple_of(2) { 1.0 } else { 2.0 * self.radius };
        (2..=D)
            .filter(|dimension| dimension % 2 == D % 2)
            .fold(lowest, |volume, dimension| volume * 2.0 * PI * self.radius * self.radius / dimension as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_are_those_of_the_textbook() {
        let disk = Ball::<2> { center: SVector::zeros(), radius: 0.5 };
        let sphere = Ball::<3> { center: SVector::zeros(), radius: 0.5 };
        assert!((disk.volume() - PI / 4.0).abs() < 1e-15);
        assert!((sphere.volume() - PI / 6.0).abs() < 1e-15);
    }
}
