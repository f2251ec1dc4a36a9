//! Box periodic along every axis, its images displaced along x or not: every wave by itself.
//!
//! With the factors `g` of the discrete gradient the equations for one wave are `(s + |g|^2) u + g p = r_u`, `-conj(g) . u = r_p`, hence
//!
//! ```text
//! p = conj(g) . r_u / |g|^2 + (1 + s / |g|^2) r_p,   u = (r_u - g p) / (s + |g|^2)
//! ```
//!
//! On an oblique grid `s` contains the [excess](Boundary::excess) of the Laplacian.

use rustfft::num_complex::Complex;

use super::{
    fourier::Waves,
    lees_edwards::Boundary,
    lines::{Lines, TILE},
    symbols::Symbols,
};
use crate::grid::Grid;

/// The last transform of a periodic box and the solution for every wave, a tile at a time.
pub struct PeriodicLines<const D: usize> {
    lines: Lines<D>,
    along: usize,
    symbols: Symbols<D>,
    shift: f64,
    /// Where the images across the boundary lie displaced.
    boundary: Option<Boundary>,
    waves: Waves,
    tile: Vec<Complex<f64>>,
}

impl<const D: usize> PeriodicLines<D> {
    /// The lines of `block`, already transformed along all other axes than `along`.
    pub fn new(lines: Lines<D>, along: usize, grid: &Grid<D>, shift: f64, symbols: Symbols<D>) -> PeriodicLines<D> {
        let (points, block) = (lines.points(), lines.block());
        let boundary = (grid.shift() > 0 || grid.slope() != 0.0).then(|| Boundary::new(grid, block.start[0]..block.end[0]));
        PeriodicLines {
            waves: Waves::new(points),
            tile: vec![Complex::default(); (D + 1) * TILE * points],
            lines,
            along,
            symbols,
            shift,
            boundary,
        }
    }

    /// Replaces rows by the solution.
    pub fn solve(&mut self, values: &mut [Complex<f64>]) {
        let (extent, points) = (self.lines.block().len(), self.lines.points());
        for tile in self.lines.tiles() {
            let size = tile.lines * points;
            let lines = &mut self.tile[..(D + 1) * size];
            (0..=D).for_each(|field| tile.gather(&values[field * extent..], &mut lines[field * size..]));
            let along_x = |line: usize| tile.line_start(line % tile.lines)[0];
            if let Some(boundary) = &self.boundary {
                lines.chunks_exact_mut(points).enumerate().for_each(|(line, values)| boundary.remove_phase(along_x(line), values));
            }
            self.waves.forward(lines);
            for line in 0..tile.lines {
                let mut factors: [&[_]; D] = std::array::from_fn(|axis| self.symbols.gradient(axis));
                let mut excess = None;
                if let Some(boundary) = &self.boundary {
                    factors[self.along] = boundary.gradient(along_x(line));
                    excess = boundary.excess(along_x(line));
                }
                let shift = |point: usize| self.shift + excess.map_or(0.0, |excess| excess[point]);
                solve_line(factors, shift, self.along, tile.line_start(line), &mut lines[line * points..], size);
            }
            self.waves.backward(lines);
            if let Some(boundary) = &self.boundary {
                lines.chunks_exact_mut(points).enumerate().for_each(|(line, values)| boundary.restore_phase(along_x(line), values));
            }
            (0..=D).for_each(|field| tile.scatter(&lines[field * size..], &mut values[field * extent..]));
        }
    }
}

/// Solves for the waves of one line; the values of the fields are `step` apart.
fn solve_line<const D: usize>(
    gradient: [&[Complex<f64>]; D],
    shift: impl Fn(usize) -> f64,
    along: usize,
    wave: [usize; D],
    line: &mut [Complex<f64>],
    step: usize,
) {
    let mut factors: [Complex<f64>; D] = std::array::from_fn(|axis| gradient[axis][wave[axis]]);
    factors[along] = Complex::default();
    let others: f64 = factors.iter().map(Complex::norm_sqr).sum();
    for (point, &factor) in gradient[along].iter().enumerate() {
        factors[along] = factor;
        let (square, shift) = (others + factor.norm_sqr(), shift(point));
        let (inverse, decay) = (1.0 / square, 1.0 / (shift + square));
        let mut source = Complex::default();
        for axis in 0..D {
            source += factors[axis].conj() * line[axis * step + point];
        }
        let pressure = source * inverse + line[D * step + point] * (1.0 + shift * inverse);
        line[D * step + point] = pressure;
        for axis in 0..D {
            let row = &mut line[axis * step + point];
            *row = (*row - factors[axis] * pressure) * decay;
        }
    }
    if others == 0.0 {
        (0..=D).for_each(|field| line[field * step] = Complex::default());
    }
}
