//! Disks and spheres.

use nalgebra::SVector;

/// A disk or a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<const D: usize> {
    /// Its centre.
    pub center: SVector<f64, D>,
    /// Its radius.
    pub radius: f64,
}

impl<const D: usize> Ball<D> {
    /// Volume (area in 2D).
    pub fn volume(&self) -> f64 {
        if D == 2 { std::f64::consts::PI * self.radius.powi(2) } else { 4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3) }
    }
}
