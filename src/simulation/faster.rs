//! What another inverse of the fluid would save, without setting it up.

use std::time::Instant;

use rustfft::{FftPlanner, num_complex::Complex};

use super::{Cost, basis::Basis};
use crate::{error::Result, flow::InverseMethod, grid::Grid};

/// Numbers in each transform that is timed, at least.
const TRANSFORMED: usize = 1 << 14;

/// Seconds of an application of the inverse by transforms over those of its Fourier transforms alone.
const BEYOND_TRANSFORMS: f64 = 2.0;

/// A faster way to the last solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Faster {
    /// The inverse.
    pub inverse: InverseMethod,
    /// Seconds that the last solve would have taken with it, about: as many iterations, each with its inverse.
    pub solve_seconds: f64,
}

/// What the fastest inverse that the box allows would make of the last solve, if it is not in use: times transforms of its lengths. Collective.
pub fn faster<const D: usize>(basis: &Basis<D>, cost: &Cost) -> Result<Option<Faster>> {
    let inverse = InverseMethod::fastest(&basis.setup.domain);
    if basis.condensed || inverse == basis.setup.inverse || cost.krylov.iterations == 0 {
        return Ok(None);
    }
    let application = BEYOND_TRANSFORMS * transform_seconds(&basis.grid);
    let seconds = basis.session.world().max(cost.stages.bodies + cost.krylov.iterations as f64 * application);
    let saves = seconds < basis.session.world().max(cost.krylov.seconds);
    Ok(saves.then_some(Faster { inverse, solve_seconds: seconds }))
}

/// Seconds in which this rank transforms its part of a fluid there and back along all periodic axes.
pub fn transform_seconds<const D: usize>(grid: &Grid<D>) -> f64 {
    let numbers = ((D + 1) * grid.local_unknowns(D)) as f64;
    let periodic = (0..D).filter(|&axis| grid.domain().periodic(axis));
    2.0 * numbers * periodic.map(|axis| seconds_each(grid.cells()[axis])).sum::<f64>()
}

/// Seconds that a transform of so many numbers takes for each of them: the shorter of two tries.
fn seconds_each(length: usize) -> f64 {
    let plan = FftPlanner::<f64>::new().plan_fft_forward(length.max(1));
    let mut numbers = vec![Complex::new(1.0, 0.0); length.max(1) * TRANSFORMED.div_ceil(length.max(1))];
    let mut once = || {
        let start = Instant::now();
        plan.process(&mut numbers);
        start.elapsed().as_secs_f64() / numbers.len() as f64
    };
    once().min(once())
}
