//! The boundary of a box whose images above it lie displaced along x by whole cells.
//!
//! For the wave `exp(2 pi i j k / n_x)` along x a displacement by `s` cells is a phase: what lies one box higher along y is the same times
//! `exp(-i theta)`, `theta = 2 pi k s / n_x`. Times `exp(i theta j / n_y)` at height `j` the wave is periodic again, and its derivative
//! there is that of the phases `2 pi m / n_y - theta / n_y`.

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
}

impl Boundary {
    /// The boundary of a grid for a range of waves along x.
    pub fn new<const D: usize>(grid: &Grid<D>, waves: Range<usize>) -> Boundary {
        let ([columns, points], spacing) = ([grid.cells()[0], grid.cells()[1]], grid.spacing()[1]);
        let tilt = |wave: usize| TAU * ((wave * grid.shift()) % columns) as f64 / (columns * points) as f64;
        let all = || waves.clone().flat_map(|wave| (0..points).map(move |point| (tilt(wave), point as f64)));
        Boundary {
            first: waves.start,
            points,
            phases: all().map(|(tilt, height)| Complex::cis(tilt * height)).collect(),
            gradient: all().map(|(tilt, wave)| derivative(TAU * wave / points as f64 - tilt) / spacing).collect(),
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

    fn of<'a>(&self, table: &'a [Complex<f64>], wave: usize) -> &'a [Complex<f64>] {
        &table[(wave - self.first) * self.points..][..self.points]
    }
}
