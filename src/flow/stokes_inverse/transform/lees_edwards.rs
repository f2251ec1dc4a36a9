//! The boundary of a box whose images above it lie displaced along x, and oblique grids.
//!
//! For the wave `exp(2 pi i j k / n_x)` along x a displacement by `s` cells is a phase: what lies one box higher along y is the same times
//! `exp(-i theta)`, `theta = 2 pi k s / n_x`. Times `exp(i theta j / n_y)` at height `j` the wave is periodic again, and its derivative
//! there is that of the phases `2 pi m / n_y - theta / n_y`.
//!
//! Where lines along y have the [slope](Grid::slope) `e`, the derivative along y is `g_y = (1 - exp(-i phi)) / h_y - e i sin(psi) (1 + exp(-i phi)) / 2 h_x` in
//! a wave of the phases `psi` along x and `phi` along y. Minus the Laplacian multiplies it by `|g|^2` and an excess of the order of `e^2`, as its stencil has no
//! node farther than the corners.

use std::{f64::consts::TAU, ops::Range};

use rustfft::num_complex::Complex;

use super::symbols::derivative;
use crate::grid::Grid;

/// What the boundary does to the waves along x that this rank solves.
pub struct Boundary {
    /// The first of these waves.
    first: usize,
    points: usize,
    /// `exp(i theta j / n_y)`, wave after wave.
    phases: Vec<Complex<f64>>,
    /// Factors by which the gradient along y multiplies waves without it, wave after wave.
    gradient: Vec<Complex<f64>>,
    /// What minus the Laplacian multiplies waves by besides the square of the gradient, wave after wave; nothing on a straight grid.
    excess: Vec<f64>,
}

impl Boundary {
    /// The boundary of a grid for a range of waves along x.
    pub fn new<const D: usize>(grid: &Grid<D>, waves: Range<usize>) -> Boundary {
        let [columns, points] = [grid.cells()[0], grid.cells()[1]];
        let tilt = |wave: usize| TAU * ((wave * grid.shift()) % columns) as f64 / (columns * points) as f64;
        let along_x = |wave: usize| TAU * wave as f64 / columns as f64;
        let all = || waves.clone().flat_map(|wave| (0..points).map(move |point| (wave, point as f64)));
        let phases = || all().map(|(wave, along_y)| [along_x(wave), TAU * along_y / points as f64 - tilt(wave)]);
        Boundary {
            first: waves.start,
            points,
            phases: all().map(|(wave, height)| Complex::cis(tilt(wave) * height)).collect(),
            gradient: phases().map(|phases| gradient(grid, phases)).collect(),
            excess: if grid.slope() == 0.0 { Vec::new() } else { phases().map(|phases| excess(grid, phases)).collect() },
        }
    }

    /// Makes a line of a wave along x periodic.
    pub fn remove_phase(&self, wave: usize, line: &mut [Complex<f64>]) {
        line.iter_mut().zip(self.of(&self.phases, wave)).for_each(|(value, phase)| *value *= phase);
    }

    /// Undoes [`remove_phase`](Self::remove_phase).
    pub fn restore_phase(&self, wave: usize, line: &mut [Complex<f64>]) {
        line.iter_mut().zip(self.of(&self.phases, wave)).for_each(|(value, phase)| *value *= phase.conj());
    }

    /// The factors of the gradient along y for the waves of a line without it.
    pub fn gradient(&self, wave: usize) -> &[Complex<f64>] {
        self.of(&self.gradient, wave)
    }

    /// For the waves of a line what minus the Laplacian multiplies them by besides the square of the gradient.
    pub fn excess(&self, wave: usize) -> Option<&[f64]> {
        (!self.excess.is_empty()).then(|| self.of(&self.excess, wave))
    }

    fn of<'a, T>(&self, table: &'a [T], wave: usize) -> &'a [T] {
        &table[(wave - self.first) * self.points..][..self.points]
    }
}

/// The derivative along y of a wave of these phases along x and y.
fn gradient<const D: usize>(grid: &Grid<D>, [x, y]: [f64; 2]) -> Complex<f64> {
    let along_lines = derivative(y) / grid.spacing()[1];
    if grid.slope() == 0.0 {
        return along_lines;
    }
    along_lines - Complex::i() * (0.5 * grid.slope() * x.sin() / grid.spacing()[0]) * (1.0 + Complex::cis(-y))
}

fn excess<const D: usize>(grid: &Grid<D>, [x, y]: [f64; 2]) -> f64 {
    let (neighbours, across) = (2.0 * (0.5 * x).sin(), x.sin() * (0.5 * y).cos());
    (grid.slope() / grid.spacing()[0]).powi(2) * (neighbours * neighbours - across * across)
}
