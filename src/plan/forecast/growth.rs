//! How the solves of a scene grow from those of its sample.

use std::time::Instant;

use rustfft::{FftPlanner, num_complex::Complex};

use super::sample::SAMPLE;
use crate::{flow::InverseMethod, grid::cells_along, setup::Setup, system::Cost};

/// Iterations grow with this power of the number of bodies.
///
/// Measured on disks at fraction 0.4: 34, 47 and 51 iterations for 10, 100 and 300 of them.
const GROWTH: f64 = 0.12;

/// The same where near pairs and pores precondition films. Measured on disks at 0.5: 18, 20 and 22 iterations for 100, 1,000 and 10,000 of them,
/// on spheres at 0.4 20, 22 and 24 for 100, 300 and 1,000.
const GROWTH_IN_FILMS: f64 = 0.06;

/// Numbers in each transform that is timed, at least.
const TRANSFORMED: usize = 1 << 16;

/// Seconds and iterations of a scene over those of its sample.
#[derive(Debug, Clone, Copy)]
pub struct Growth {
    /// Of what is done once on the grid.
    pub grid: f64,
    /// Of what each iteration does on the grid.
    grid_in_iterations: f64,
    /// Of what is done on surfaces.
    pub bodies: f64,
    /// Of the number of iterations.
    pub iterations: f64,
}

impl Growth {
    /// To a setup with so many unknowns of the grid and multipliers, from a sample that has cost so much.
    pub fn of<const D: usize>(setup: &Setup<D>, (grid, multipliers): (usize, usize), sample: &Setup<D>, cost: &Cost) -> Growth {
        let times = grid as f64 / cost.grid_unknowns as f64;
        let growth = if setup.interactions.resist() { GROWTH_IN_FILMS } else { GROWTH };
        // each multiplier acts on the rows about its surface
        let rows = (sample.spacing / setup.spacing).powi(D as i32 - 1);
        let suited = if setup.inverse == InverseMethod::Transform { transforms(setup, sample) } else { 1.0 };
        Growth {
            grid: times,
            grid_in_iterations: times * suited,
            bodies: multipliers.max(1) as f64 / cost.multiplier_unknowns.max(1) as f64 * rows,
            iterations: (setup.bodies.len() as f64 / SAMPLE as f64).max(1.0).powf(growth),
        }
    }

    /// Seconds of a solve that takes some on the sample, a part of them on surfaces.
    pub fn solve(&self, seconds: f64, on_surfaces: f64) -> f64 {
        ((seconds - on_surfaces).max(0.0) * self.grid_in_iterations + on_surfaces * self.bodies) * self.iterations
    }
}

/// Seconds that transforms of a grid take for each cell, over those of a sample's.
fn transforms<const D: usize>(setup: &Setup<D>, sample: &Setup<D>) -> f64 {
    let of_grid = |setup: &Setup<D>| {
        // between walls a box is transformed along all axes if it is along more than one
        let all = !setup.inverse.is_exact(&setup.domain);
        let axes = (0..D).filter(|&axis| all || setup.domain.periodic(axis));
        axes.map(|axis| transform(cells_along(&setup.domain.size, setup.spacing)[axis] as usize)).sum::<f64>()
    };
    let (one, other) = (of_grid(setup), of_grid(sample));
    if other > 0.0 { one / other } else { 1.0 }
}

/// Seconds that a Fourier transform of so many numbers takes for each.
fn transform(length: usize) -> f64 {
    let length = length.max(1);
    let plan = FftPlanner::<f64>::new().plan_fft_forward(length);
    let mut numbers = vec![Complex::new(1.0, 0.0); length * TRANSFORMED.div_ceil(length)];
    let mut once = || {
        let start = Instant::now();
        plan.process(&mut numbers);
        start.elapsed().as_secs_f64() / numbers.len() as f64
    };
    once().min(once())
}
