//! Discrete Fourier transforms of all fields along one axis, not normalised: `f_k = sum_j f_j exp(-2 pi i j k / n)` and back.

use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftDirection, FftPlanner, num_complex::Complex};

use super::lines::{Lines, TILE};

/// What of a transform of planned lengths cannot go wrong.
const PLANNED: &str = "lengths are as planned, and constant and fastest waves are real";

/// Transforms from points to waves and back. Like the plans of real values it is a function of no parameters of type, so that the planner, whose code is large, is
/// compiled with this crate alone.
fn complex_plans(points: usize) -> [Arc<dyn Fft<f64>>; 2] {
    let mut planner = FftPlanner::new();
    [FftDirection::Forward, FftDirection::Inverse].map(|direction| planner.plan_fft(points, direction))
}

/// Transforms from real values to waves and back.
fn real_plans(points: usize) -> (Arc<dyn RealToComplex<f64>>, Arc<dyn ComplexToReal<f64>>) {
    let mut planner = RealFftPlanner::new();
    (planner.plan_fft_forward(points), planner.plan_fft_inverse(points))
}

/// Transforms of lines of complex values, in place.
pub struct Waves {
    forward: Arc<dyn Fft<f64>>,
    backward: Arc<dyn Fft<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Waves {
    /// Transforms of `points` points.
    pub fn new(points: usize) -> Waves {
        let [forward, backward] = complex_plans(points);
        let size = forward.get_inplace_scratch_len().max(backward.get_inplace_scratch_len());
        Waves { forward, backward, scratch: vec![Complex::default(); size] }
    }

    /// From points to waves, line after line.
    pub fn forward(&mut self, lines: &mut [Complex<f64>]) {
        self.forward.process_with_scratch(lines, &mut self.scratch);
    }

    /// From waves to points, line after line.
    pub fn backward(&mut self, lines: &mut [Complex<f64>]) {
        self.backward.process_with_scratch(lines, &mut self.scratch);
    }
}

/// Transforms of all fields of a block along one axis.
pub struct ComplexTransform<const D: usize> {
    lines: Lines<D>,
    waves: Waves,
    tile: Vec<Complex<f64>>,
}

impl<const D: usize> ComplexTransform<D> {
    /// Transforms along `lines`.
    pub fn new(lines: Lines<D>) -> ComplexTransform<D> {
        let points = lines.points();
        ComplexTransform { lines, waves: Waves::new(points), tile: vec![Complex::default(); TILE * points] }
    }

    /// From points to waves, all fields.
    pub fn forward(&mut self, values: &mut [Complex<f64>]) {
        self.each_tile(values, Waves::forward);
    }

    /// From waves to points, all fields.
    pub fn backward(&mut self, values: &mut [Complex<f64>]) {
        self.each_tile(values, Waves::backward);
    }

    fn each_tile(&mut self, values: &mut [Complex<f64>], transform: fn(&mut Waves, &mut [Complex<f64>])) {
        let extent = self.lines.block().len();
        for field in values.chunks_exact_mut(extent.max(1)).take(D + 1) {
            for tile in self.lines.tiles() {
                let lines = &mut self.tile[..tile.lines * tile.points];
                tile.gather(field, lines);
                transform(&mut self.waves, lines);
                tile.scatter(lines, field);
            }
        }
    }
}

/// Transforms of all fields between real values and the waves up to the fastest, `n / 2 + 1` of them, along one axis.
pub struct RealTransform<const D: usize> {
    real: Lines<D>,
    complex: Lines<D>,
    forward: Arc<dyn RealToComplex<f64>>,
    backward: Arc<dyn ComplexToReal<f64>>,
    real_tile: Vec<f64>,
    complex_tile: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl<const D: usize> RealTransform<D> {
    /// Transforms between the lines of two blocks that differ only along the axis.
    pub fn new(real: Lines<D>, complex: Lines<D>) -> RealTransform<D> {
        let (forward, backward) = real_plans(real.points());
        let size = forward.get_scratch_len().max(backward.get_scratch_len());
        RealTransform {
            forward,
            backward,
            real_tile: vec![0.0; TILE * real.points()],
            complex_tile: vec![Complex::default(); TILE * complex.points()],
            scratch: vec![Complex::default(); size],
            real,
            complex,
        }
    }

    /// From points to waves, all fields; the values are used up.
    pub fn forward(&mut self, values: &mut [f64], waves: &mut [Complex<f64>]) {
        let (real_extent, complex_extent) = (self.real.block().len(), self.complex.block().len());
        let mut transform = |points: &mut [f64], waves: &mut [Complex<f64>]| {
            for (points, waves) in points.chunks_exact_mut(self.real.points()).zip(waves.chunks_exact_mut(self.complex.points())) {
                self.forward.process_with_scratch(points, waves, &mut self.scratch).expect(PLANNED);
            }
        };
        if self.real.in_sequence() {
            return transform(&mut values[..(D + 1) * real_extent], waves);
        }
        for field in 0..=D {
            for (real, complex) in self.real.tiles().zip(self.complex.tiles()) {
                let points = &mut self.real_tile[..real.lines * real.points];
                real.gather(&values[field * real_extent..], points);
                transform(points, &mut self.complex_tile);
                complex.scatter(&self.complex_tile, &mut waves[field * complex_extent..]);
            }
        }
    }

    /// From waves to points, all fields; the waves are used up.
    pub fn backward(&mut self, waves: &mut [Complex<f64>], values: &mut [f64]) {
        let (real_extent, complex_extent) = (self.real.block().len(), self.complex.block().len());
        let mut transform = |waves: &mut [Complex<f64>], points: &mut [f64]| {
            for (points, waves) in points.chunks_exact_mut(self.real.points()).zip(waves.chunks_exact_mut(self.complex.points())) {
                waves[0].im = 0.0;
                if points.len() % 2 == 0 {
                    waves[points.len() / 2].im = 0.0;
                }
                self.backward.process_with_scratch(waves, points, &mut self.scratch).expect(PLANNED);
            }
        };
        if self.real.in_sequence() {
            return transform(waves, &mut values[..(D + 1) * real_extent]);
        }
        for field in 0..=D {
            for (real, complex) in self.real.tiles().zip(self.complex.tiles()) {
                complex.gather(&waves[field * complex_extent..], &mut self.complex_tile);
                let points = &mut self.real_tile[..real.lines * real.points];
                transform(&mut self.complex_tile, points);
                real.scatter(points, &mut values[field * real_extent..]);
            }
        }
    }
}
