//! What another inverse of the fluid would save.

use std::time::Instant;

use super::{Cost, fixed_operators::FixedOperators};
use crate::{error::Result, flow::InverseMethod};

/// Applications that are timed, after one that warms up.
const APPLICATIONS: usize = 2;

/// A faster way to the last solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Faster {
    /// The inverse.
    pub inverse: InverseMethod,
    /// Seconds that the last solve would have taken with it, at most: as many iterations, each with its inverse.
    pub solve_seconds: f64,
}

/// What the fastest inverse that the box allows would make of the last solve, if it is not in use: sets it up and times it. Collective.
pub fn faster<const D: usize>(fixed: &FixedOperators<D>, cost: &Cost) -> Result<Option<Faster>> {
    let inverse = InverseMethod::fastest(&fixed.setup.domain);
    if fixed.condensed || inverse == fixed.setup.inverse || cost.krylov.iterations == 0 {
        return Ok(None);
    }
    let mut other = inverse.set_up(&fixed.stokes, &fixed.grid)?;
    let (rows, mut fluid) = (fixed.stokes.vector()?, fixed.stokes.vector()?);
    other.precondition(&fixed.stokes, &rows, &mut fluid)?;
    let start = Instant::now();
    for _ in 0..APPLICATIONS {
        other.precondition(&fixed.stokes, &rows, &mut fluid)?;
    }
    let application = start.elapsed().as_secs_f64() / APPLICATIONS as f64;
    let seconds = fixed.session.world().max(cost.stages.bodies + cost.krylov.iterations as f64 * application);
    let saves = seconds < fixed.session.world().max(cost.krylov.seconds);
    Ok(saves.then_some(Faster { inverse, solve_seconds: seconds }))
}
