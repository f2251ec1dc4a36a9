//! What the discrete derivatives do to waves.

use std::f64::consts::TAU;

use rustfft::num_complex::Complex;

use crate::grid::Grid;

/// The factors by which the discrete gradient multiplies waves along each axis.
///
/// Velocities live on the lower faces of the cells: for the wave `exp(2 pi i j k / n)` of the pressure the derivative at face `j`
/// is `(p_j - p_{j-1}) / h = g_k p_j` with `g_k = (1 - exp(-2 pi i k / n)) / h`; the divergence multiplies by `-conj(g_k)` and
/// minus the Laplacian by `|g_k|^2`.
#[derive(Clone)]
pub struct Symbols<const D: usize> {
    gradient: [Vec<Complex<f64>>; D],
}

impl<const D: usize> Symbols<D> {
    /// The factors for all waves of a grid.
    pub fn new(grid: &Grid<D>) -> Symbols<D> {
        let factor = |axis: usize, wave: usize| derivative(TAU * wave as f64 / grid.cells()[axis] as f64) / grid.spacing()[axis];
        Symbols { gradient: std::array::from_fn(|axis| (0..grid.cells()[axis]).map(|wave| factor(axis, wave)).collect()) }
    }

    /// The factors of all waves along an axis.
    pub fn gradient(&self, axis: usize) -> &[Complex<f64>] {
        &self.gradient[axis]
    }
}

/// `1 - exp(-i phase)`: the difference between a point and the one before it in a wave that grows by `phase` from point to point.
pub fn derivative(phase: f64) -> Complex<f64> {
    // 1 - cos by the half angle keeps all digits of slow waves
    Complex::new(2.0 * (phase / 2.0).sin().powi(2), phase.sin())
}
