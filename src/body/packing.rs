//! Random packings: centres of balls that keep a gap to each other, to walls and to obstacles.
//!
//! Bodies start anywhere and push each other apart. If that stalls, they start over smaller, are
//! shaken and grow, step by step. The effort is counted in pairs looked at, not in seconds, so that
//! every machine and every rank gets the same packing.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::relaxation::Crowd;
use crate::error::{Error, Result};
use crate::geometry::{Ball, Domain};

/// Pair evaluations spent at most: some seconds.
const EFFORT: u64 = 300_000_000;
/// Pair evaluations spent at most in addition, for each body.
const EFFORT_PER_BODY: u64 = 20_000;
/// First step of the growth of the radii, relative to the final radii.
const GROWTH: f64 = 0.02;
/// Step of the growth below which bodies are stuck.
const STUCK: f64 = 5e-4;
/// Fraction from which radii grow, easy to reach in any dimension.
const EASY_FRACTION: f64 = 0.4;
/// Shift of a shaken body along each axis, in radii.
const SHAKE: f64 = 0.2;
/// Excess of a width over the box that is rounding.
const TOLERANCE: f64 = 1e-9;

/// Random centres of balls of the given radii that overlap neither each other nor walls nor obstacles.
///
/// `gap` is the smallest distance between surfaces: times the mean radius of the two for a pair, times
/// the radius to a wall. Obstacles stay where they are. Centres lie in `[0, size)`. The same
/// arguments give the same centres everywhere. Returns [`Error::Refused`] if a radius or the gap
/// is no usable number, if a body does not fit, or if no packing is found with bounded effort.
pub fn pack<const D: usize>(domain: &Domain<D>, obstacles: &[Ball<D>], radii: &[f64], gap: f64, seed: u64) -> Result<Vec<SVector<f64, D>>> {
    if radii.is_empty() {
        return Ok(Vec::new());
    }
    check_numbers(radii, gap)?;
    for (body, &radius) in radii.iter().enumerate() {
        check_fit(domain, body, radius, gap)?;
    }
    let mut search = Search::new(domain, obstacles, radii, gap, seed);
    if search.run() {
        let centers = &search.crowd.centers[..radii.len()];
        return Ok(centers.iter().map(|&center| domain.wrap(center)).collect());
    }
    Err(refusal(domain, radii, gap, search.best_scale))
}

fn check_numbers(radii: &[f64], gap: f64) -> Result<()> {
    if !(gap.is_finite() && gap >= 0.0) {
        return Err(Error::Refused(format!("`gap` is {gap}; it must be zero or positive")));
    }
    match radii.iter().position(|radius| !(radius.is_finite() && *radius > 0.0)) {
        Some(body) => Err(Error::Refused(format!("body {body} has radius {}; it must be positive", radii[body]))),
        None => Ok(()),
    }
}

/// Refuses a body that is wider than the box along some axis.
fn check_fit<const D: usize>(domain: &Domain<D>, body: usize, radius: f64, gap: f64) -> Result<()> {
    for axis in 0..D {
        let (size, name) = (domain.size[axis], ["x", "y", "z"].get(axis).unwrap_or(&"?"));
        let (width, reason) = if domain.periodic(axis) {
            (2.0 * radius * (1.0 + gap / 2.0), "overlaps its own periodic image")
        } else {
            (2.0 * radius * (1.0 + gap), "does not fit between the walls")
        };
        if width > size * (1.0 + TOLERANCE) {
            return Err(Error::Refused(format!(
                "body {body} of radius {radius} {reason}: with a `gap` of {gap} it needs {width:.6} \
                 along {name}, but the box has {size}; lower the radius or `gap`, or enlarge `size`"
            )));
        }
    }
    Ok(())
}

fn refusal<const D: usize>(domain: &Domain<D>, radii: &[f64], gap: f64, scale: f64) -> Error {
    let asked = fraction(domain, radii);
    let swollen = 1.0 + gap / 2.0;
    let reached = asked * power::<D>(scale);
    let largest_gap = 2.0 * (scale * swollen - 1.0);
    let remedy = if largest_gap > 0.0 {
        format!("lower `gap` below {largest_gap:.4} or `fraction` below {reached:.3}")
    } else {
        format!("lower `fraction` below {reached:.3}, or less with a smaller `gap`")
    };
    Error::Refused(format!(
        "{} bodies of fraction {asked:.3} ({:.3} with their `gap` of {gap} counted) do not fit into the \
         box: the search reached {reached:.3} ({:.3}); {remedy}",
        radii.len(),
        asked * power::<D>(swollen),
        reached * power::<D>(swollen),
    ))
}

/// Part of the box that balls of these radii fill.
fn fraction<const D: usize>(domain: &Domain<D>, radii: &[f64]) -> f64 {
    let volume = |&radius| Ball::<D> { center: SVector::zeros(), radius }.volume();
    radii.iter().map(volume).sum::<f64>() / domain.volume()
}

/// `number^D` by products, which round alike on every platform.
fn power<const D: usize>(number: f64) -> f64 {
    (0..D).fold(1.0, |product, _| product * number)
}

/// The search for a packing.
struct Search<'a, const D: usize> {
    crowd: Crowd<'a, D>,
    random: ChaCha8Rng,
    /// Scale of the radii from which they grow.
    easy_scale: f64,
    /// Largest scale of the radii without overlaps so far.
    best_scale: f64,
}

impl<'a, const D: usize> Search<'a, D> {
    fn new(domain: &'a Domain<D>, obstacles: &[Ball<D>], radii: &[f64], gap: f64, seed: u64) -> Self {
        let all = || radii.iter().copied().chain(obstacles.iter().map(|ball| ball.radius));
        let swollen: Vec<_> = all().map(|radius| radius * (1.0 + gap / 2.0)).collect();
        let full = fraction(domain, &swollen[..radii.len()]);
        let mut easy_scale = 1.0;
        while full * power::<D>(easy_scale) > EASY_FRACTION {
            easy_scale *= 0.98;
        }
        let centers = radii.iter().map(|_| SVector::zeros());
        let crowd = Crowd {
            domain,
            centers: centers.chain(obstacles.iter().map(|ball| ball.center)).collect(),
            radii: swollen,
            wall_radii: radii.iter().map(|radius| radius * (1.0 + gap)).collect(),
            movable: radii.len(),
            effort: EFFORT + EFFORT_PER_BODY * radii.len() as u64,
        };
        Self { crowd, random: ChaCha8Rng::seed_from_u64(seed), easy_scale, best_scale: 0.0 }
    }

    /// Looks for a packing until one is found or the effort is spent.
    fn run(&mut self) -> bool {
        self.scatter();
        if self.crowd.relax(1.0) {
            return true;
        }
        while self.crowd.effort > 0 {
            self.scatter();
            if self.grow() {
                return true;
            }
        }
        false
    }

    /// Puts every body at a random place, outside obstacles if that is easy.
    fn scatter(&mut self) {
        for body in 0..self.crowd.movable {
            for _ in 0..100 {
                self.crowd.centers[body] = SVector::from_fn(|axis, _| self.random.random::<f64>() * self.crowd.domain.size[axis]);
                if !self.buried(body) {
                    break;
                }
            }
        }
    }

    /// Whether the centre of a body lies in an obstacle.
    fn buried(&self, body: usize) -> bool {
        let crowd = &self.crowd;
        (crowd.movable..crowd.centers.len()).any(|obstacle| {
            let separation = crowd.centers[obstacle] - crowd.centers[body];
            crowd.domain.nearest_image(separation).norm() < crowd.radii[obstacle]
        })
    }

    /// Lets shaken bodies grow from an easy fraction until they have their radii or are stuck.
    fn grow(&mut self) -> bool {
        let mut scale = self.easy_scale;
        if !self.crowd.relax(scale) {
            return false;
        }
        let mut step = GROWTH;
        while step > STUCK {
            self.best_scale = self.best_scale.max(scale);
            if scale >= 1.0 {
                return true;
            }
            let centers = self.crowd.centers.clone();
            let larger = (scale + step).min(1.0);
            self.shake(scale);
            if self.crowd.relax(larger) {
                scale = larger;
            } else {
                self.crowd.centers = centers;
                step /= 2.0;
            }
            if self.crowd.effort == 0 {
                return false;
            }
        }
        false
    }

    fn shake(&mut self, scale: f64) {
        for body in 0..self.crowd.movable {
            let shift = 2.0 * SHAKE * scale * self.crowd.radii[body];
            self.crowd.centers[body] += SVector::from_fn(|_, _| shift * (self.random.random::<f64>() - 0.5));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, first_fault, near_pairs, near_walls};
    use std::time::Instant;

    fn cube<const D: usize>(walled: bool) -> Domain<D> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        Domain { size: SVector::repeat(1.0), axes: [if walled { wall } else { Axis::Periodic }; D] }
    }

    /// Equal radii that fill the fraction of the unit box.
    fn equal<const D: usize>(count: usize, asked: f64) -> Vec<f64> {
        let unit = fraction::<D>(&cube(false), &vec![1.0; count]);
        vec![(asked / unit).powf(1.0 / D as f64); count]
    }

    fn assert_packed<const D: usize>(
        domain: &Domain<D>,
        obstacles: &[Ball<D>],
        radii: &[f64],
        gap: f64,
        seed: u64,
    ) -> Vec<SVector<f64, D>> {
        let centers = pack(domain, obstacles, radii, gap, seed).unwrap();
        let bodies = centers.iter().zip(radii).map(|(&center, &radius)| Ball { center, radius });
        let balls: Vec<_> = bodies.chain(obstacles.iter().copied()).collect();
        assert_eq!(first_fault(domain, &balls[..radii.len()]), None);
        for pair in near_pairs(domain, &balls, 2.0 * gap * radii[0]) {
            let mean = 0.5 * (balls[pair.first].radius + balls[pair.second].radius);
            let fixed = pair.first >= radii.len();
            assert!(fixed || pair.gap >= (gap - 1e-9) * mean, "{pair:?}");
        }
        for wall in near_walls(domain, &balls[..radii.len()], 1.0) {
            assert!(wall.gap >= (gap - 1e-9) * radii[wall.body], "{wall:?}");
        }
        for center in &centers {
            assert!((0..D).all(|axis| (0.0..domain.size[axis]).contains(&center[axis])));
        }
        centers
    }

    #[test]
    #[ignore]
    fn timings() {
        fn time<const D: usize>(count: usize, asked: f64, gap: f64) {
            for walled in [false, true] {
                for seed in 0..5 {
                    let start = Instant::now();
                    let result = pack::<D>(&cube(walled), &[], &equal::<D>(count, asked), gap, seed);
                    let error = result.map(|_| ()).map_err(|e| e.to_string());
                    eprintln!(
                        "{D}D {count} at {asked} gap {gap} walled {walled} seed {seed}: {:.3} s {error:?}",
                        start.elapsed().as_secs_f64()
                    );
                }
            }
        }
        time::<2>(400, 0.4, 0.1);
        time::<3>(64, 0.3, 0.1);
        time::<2>(10_000, 0.5, 0.02);
        time::<2>(400, 0.75, 0.01);
        time::<3>(200, 0.55, 0.01);
    }
}
