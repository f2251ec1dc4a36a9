//! Uzawa's iteration for the mean-value method, as it was published: `lambda += step (V - u)` on the surfaces.
//!
//! Each iteration solves the box once for given multipliers and takes the velocity that the surfaces then lack; on a free
//! body that is `m(u) - u`, since net force and torque are given. The step has a bound, `2` over the largest eigenvalue of the mobility,
//! beyond which it diverges; the smallest eigenvalue falls like the wavelength of the highest mode, so iterations grow like `1/h`.

use std::time::Instant;

use super::{krylov_workspace::Stop, schur_complement::SchurComplement};
use crate::{
    error::{Error, Result},
    petsc::{Report, System, Vector},
    system::ResidualMonitor,
};

/// Iterations allowed.
const MOST_ITERATIONS: usize = 5000;

/// Growth of the residual that counts as divergence.
const BEYOND_HOPE: f64 = 1e3;

/// Iterations that estimate the largest eigenvalue, and by how much at most they miss it.
const ESTIMATE: (usize, f64) = (20, 1.1);

/// Part of the bound that an automatic step takes.
const PART_OF_BOUND: f64 = 0.9;

/// Solves the condensed system to a relative residual, with the given step or one below the estimated bound.
///
/// # Errors
/// [`Error::Diverged`] with the bound of the step, and [`Error::Refused`] where rows are no velocities: contacts that press, or mean
/// velocities that fixed bodies have to find.
pub fn uzawa<const D: usize>(
    system: &mut SchurComplement<D>,
    rhs: &Vector,
    x: &mut Vector,
    step: Option<f64>,
    Stop { tolerance, rounding }: Stop,
    monitor: ResidualMonitor,
) -> Result<Report> {
    let start = Instant::now();
    if !system.0.surfaces.velocities_only() {
        return Err(Error::refused(
            "method.solver = \"uzawa\" supports no contacts and no mean velocity under a uniform force on fixed bodies; use \"krylov\"",
        ));
    }
    let step = step.map_or_else(|| bound(system, x).map(|bound| PART_OF_BOUND * bound), Ok)?;
    let (mut residual, scale) = (rhs.like()?, rhs.norm()?.max(rounding / tolerance).max(f64::MIN_POSITIVE));
    let mut first = 0.0;
    for iterations in 0..=MOST_ITERATIONS {
        system.apply(x, &mut residual)?;
        residual.scale(-1.0)?;
        residual.add(1.0, rhs)?;
        let relative = residual.norm()? / scale;
        monitor(iterations, relative);
        if relative <= tolerance {
            return Ok(Report { iterations, residual: relative, seconds: start.elapsed().as_secs_f64() });
        }
        first = if iterations == 0 { relative } else { first };
        if !relative.is_finite() || relative > BEYOND_HOPE * first.max(1.0) {
            return Err(diverged(step, bound(system, x)?, iterations));
        }
        system.0.surfaces.weigh(step, &mut residual)?;
        x.add(1.0, &residual)?;
    }
    Err(Error::Diverged(format!(
        "Uzawa's iteration does not reach {tolerance:.1e} in {MOST_ITERATIONS} iterations of step {step:.3}; \
         set method.solver = \"krylov\", or method.uzawa_step nearer to its bound {:.3}",
        bound(system, x)?
    )))
}

fn diverged(step: f64, bound: f64, iterations: usize) -> Error {
    Error::Diverged(format!(
        "Uzawa's iteration diverged after {iterations} iterations: method.uzawa_step = {step:.3} lies beyond its bound, about {bound:.3}; \
         lower it, or set it to \"auto\""
    ))
}

/// Two over the largest eigenvalue of the mobility, estimated by power iterations, from below.
fn bound<const D: usize>(system: &mut SchurComplement<D>, shape: &Vector) -> Result<f64> {
    let (mut vector, mut image) = (shape.like()?, shape.like()?);
    let first = vector.range()?.start;
    // every mode has a part in it, the same on any number of ranks
    vector.local_mut()?.iter_mut().enumerate().for_each(|(place, value)| *value = 1.0 + 0.5 * ((first + place) as f64).sin());
    let mut largest = 0.0;
    for _ in 0..ESTIMATE.0 {
        let norm = vector.norm()?;
        vector.scale(1.0 / norm)?;
        system.apply(&vector, &mut image)?;
        system.0.surfaces.weigh(1.0, &mut image)?;
        // rows of given forces answer with the force, and 1 is no eigenvalue of a mobility
        system.0.surfaces.without_given_forces(&mut image)?;
        largest = image.norm()?;
        vector.copy_from(&image)?;
    }
    Ok(2.0 / (ESTIMATE.1 * largest))
}
