//! Configurations of hard balls in equilibrium, by the method of Metropolis et al. 1953 (doi:10.1063/1.1699114).
//!
//! A packing that was relaxed has too many pairs at its smallest gap, and with them too high a viscosity. Random moves that make no two
//! bodies overlap, kept one by one, lead to all configurations alike.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::packing::pack;
use crate::{
    error::Result,
    geometry::{Ball, Domain, Levels},
};

/// Trials a body.
const SWEEPS: usize = 200;

/// Longest trial move along each axis, in radii.
const LONGEST: f64 = 1.0;

/// Random centres of balls in equilibrium with no gap, to each other or to a wall, below `gap` radii of the two (of the one) at their mean.
///
/// # Errors
/// They do not fit.
pub fn equilibrium<const D: usize>(domain: &Domain<D>, radii: &[f64], gap: f64, seed: u64) -> Result<Vec<SVector<f64, D>>> {
    let centers = pack(domain, &[] as &[Ball<D>], radii, gap, seed)?;
    let mut balls: Vec<Ball<D>> = centers.into_iter().zip(radii).map(|(center, &radius)| Ball { center, radius }).collect();
    let mut places = Levels::new(domain);
    balls.iter().enumerate().for_each(|(body, ball)| places.insert(body, ball));
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for _ in 0..SWEEPS * radii.len() {
        let body = random.random_range(0..balls.len());
        let step = SVector::from_fn(|_, _| (2.0 * random.random::<f64>() - 1.0) * LONGEST * balls[body].radius);
        let trial = domain.wrap(balls[body].center + step);
        if fits(domain, &balls, &places, body, trial, gap) {
            places.remove(body, &balls[body]);
            balls[body].center = trial;
            places.insert(body, &balls[body]);
        }
    }
    Ok(balls.into_iter().map(|ball| ball.center).collect())
}

/// Whether a body at a place keeps its distance to all others and to walls.
fn fits<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], places: &Levels<D>, body: usize, place: SVector<f64, D>, gap: f64) -> bool {
    let radius = balls[body].radius;
    let (reach, factor) = (radius * (1.0 + gap), 1.0 + 0.5 * gap);
    if (0..D).any(|axis| !domain.periodic(axis) && !(reach..=domain.size[axis] - reach).contains(&place[axis])) {
        return false;
    }
    let mut apart = true;
    places.visit_within(&Ball { center: place, radius }, factor, |other| {
        let least = (radius + balls[other].radius) * factor;
        apart &= other == body || domain.nearest_image(balls[other].center - place).norm_squared() >= least * least;
    });
    apart
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, LeesEdwards, near_pairs, near_walls};

    /// At contact the pair distribution of hard disks is `(1 - 0.436 f) / (1 - f)^2`, with `f` the fraction, hard gaps included
    /// (Henderson 1975, doi:10.1080/00268977500102511): 1.19 at 0.1. The packing alone has a peak there.
    #[test]
    fn disks_in_equilibrium_are_no_more_often_in_contact_than_theory_says() {
        let (count, fraction, gap) = (64, 0.1, 0.02);
        let radius = (fraction / (count as f64 * std::f64::consts::PI)).sqrt();
        let domain = Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; 2] };
        let (near, far) = (2.0 + gap, 2.4);
        let mut found = [0.0; 2];
        for seed in 1..=40 {
            let packed = pack(&domain, &[] as &[Ball<2>], &vec![radius; count], gap, seed).unwrap();
            for (found, centers) in found.iter_mut().zip([equilibrium(&domain, &vec![radius; count], gap, seed).unwrap(), packed]) {
                let balls: Vec<Ball<2>> = centers.into_iter().map(|center| Ball { center, radius }).collect();
                let pairs = near_pairs(&domain, &balls, (far - 2.0) * radius);
                assert!(pairs.iter().all(|pair| pair.gap > (gap - 1e-9) * radius));
                *found += pairs.len() as f64 / 40.0;
            }
        }
        let shell = std::f64::consts::PI * (far * far - near * near) * radius * radius;
        let ideal = 0.5 * (count * (count - 1)) as f64 * shell;
        let effective = fraction * (1.0 + 0.5 * gap).powi(2);
        let contact = (1.0 - 0.436 * effective) / (1.0 - effective).powi(2);
        let [equilibrium, packed] = found.map(|pairs| pairs / ideal);
        // over the shell the distribution falls by a few percent; some 270 pairs scatter by 0.08
        assert!((equilibrium - contact).abs() < 0.25, "{equilibrium} instead of {contact}");
        assert!(packed > 1.5 * equilibrium, "{packed} in the packing");
    }

    #[test]
    fn walls_and_unequal_radii_keep_their_gaps_and_seeds_their_places() {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let domain = Domain { size: SVector::from([6.0, 5.0, 7.0]), axes: [Axis::Periodic, wall, Axis::Periodic] };
        let radii: Vec<f64> = (0..20).map(|body| if body % 2 == 0 { 0.5 } else { 0.7 }).collect();
        let centers = equilibrium(&domain, &radii, 0.1, 3).unwrap();
        let balls: Vec<Ball<3>> = centers.iter().zip(&radii).map(|(&center, &radius)| Ball { center, radius }).collect();
        assert!(near_pairs(&domain, &balls, 0.2).iter().all(|pair| pair.gap > 0.0499 * (radii[pair.first] + radii[pair.second])));
        assert!(near_walls(&domain, &balls, 0.2).iter().all(|pair| pair.gap > 0.0999 * radii[pair.body]));
        assert_eq!(centers, equilibrium(&domain, &radii, 0.1, 3).unwrap());
    }

    /// What a look at all others says.
    fn fits_among_all<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], body: usize, place: SVector<f64, D>, gap: f64) -> bool {
        let reach = balls[body].radius * (1.0 + gap);
        let within = |axis: usize| domain.periodic(axis) || (place[axis] >= reach && place[axis] <= domain.size[axis] - reach);
        let apart = |other: usize| {
            let least = (balls[body].radius + balls[other].radius) * (1.0 + 0.5 * gap);
            domain.nearest_image(balls[other].center - place).norm_squared() >= least * least
        };
        (0..D).all(within) && (0..balls.len()).filter(|&other| other != body).all(apart)
    }

    /// Counts the trials that are in the way of others and those that are not.
    fn compare<const D: usize>(domain: &Domain<D>, radii: &[f64], random: &mut ChaCha8Rng) -> [usize; 2] {
        let mut anywhere = || SVector::from_fn(|axis, _| random.random::<f64>() * domain.size[axis]);
        let mut balls: Vec<Ball<D>> = radii.iter().map(|&radius| Ball { center: anywhere(), radius }).collect();
        let mut places = Levels::new(domain);
        balls.iter().enumerate().for_each(|(body, ball)| places.insert(body, ball));
        let mut counts = [0; 2];
        for trial in 0..2000 {
            let (body, place) = (trial % balls.len(), anywhere());
            let fit = fits(domain, &balls, &places, body, place, 0.1);
            assert_eq!(fit, fits_among_all(domain, &balls, body, place, 0.1), "{:?} to {place:?}", balls[body]);
            counts[usize::from(fit)] += 1;
            places.remove(body, &balls[body]);
            balls[body].center = place;
            places.insert(body, &balls[body]);
        }
        counts
    }

    #[test]
    fn a_look_at_those_near_says_what_a_look_at_all_says() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let sheared = Axis::Sheared(LeesEdwards::steady(0.7, 0.0, 0.0));
        let radii: Vec<f64> = (0..40).map(|body| 0.02 + 0.2 * f64::from(body % 10).powi(4) / 1e4).collect();
        for second in [Axis::Periodic, wall, sheared] {
            let flat = Domain { size: SVector::from([4.0, 1.3]), axes: [Axis::Periodic, second] };
            let counts = compare(&flat, &radii, &mut random);
            assert!(counts.iter().all(|&trials| trials > 200), "{counts:?}");
        }
        let deep = Domain { size: SVector::from([1.0, 1.3, 0.9]), axes: [Axis::Periodic; 3] };
        let counts = compare(&deep, &radii, &mut random);
        assert!(counts.iter().all(|&trials| trials > 200), "{counts:?}");
    }
}
