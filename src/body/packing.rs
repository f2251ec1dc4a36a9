//! Random packings: centres of balls that keep a gap to each other, to walls and to obstacles.
//!
//! This is the door: it refuses what cannot be packed and says why. The search itself is beside it.

use nalgebra::SVector;

use super::search::{Search, fraction, power};
use crate::error::{Error, Result};
use crate::geometry::{Ball, Domain};
use crate::parallel::Peers;

/// Excess of a width over the box that is rounding.
const TOLERANCE: f64 = 1e-9;

/// Random centres of balls of the given radii that overlap neither each other nor walls nor obstacles.
///
/// `gap` is the smallest distance between surfaces: times the mean radius of the two for a pair, times
/// the radius to a wall. Obstacles stay where they are. Centres lie in `[0, size)`. The same arguments give the same centres
/// everywhere. Returns [`Error::Refused`] if a radius or the gap
/// is no usable number, if a body does not fit, or if no packing is found with bounded effort.
pub fn pack<const D: usize>(domain: &Domain<D>, obstacles: &[Ball<D>], radii: &[f64], gap: f64, seed: u64) -> Result<Vec<SVector<f64, D>>> {
    pack_on(Peers::Alone, domain, obstacles, radii, gap, seed)
}

/// The same by several ranks, which share many bodies; collective. All arguments and what comes out are the same on every rank.
pub fn pack_on<const D: usize>(
    peers: Peers,
    domain: &Domain<D>,
    obstacles: &[Ball<D>],
    radii: &[f64],
    gap: f64,
    seed: u64,
) -> Result<Vec<SVector<f64, D>>> {
    if radii.is_empty() {
        return Ok(Vec::new());
    }
    check_numbers(radii, gap)?;
    for (body, &radius) in radii.iter().enumerate() {
        check_fit(domain, body, radius, gap)?;
    }
    let search = Search::new(peers, domain, obstacles, radii, gap, seed);
    search.run().map_err(|scale| refusal(domain, radii, gap, scale))
}

fn check_numbers(radii: &[f64], gap: f64) -> Result<()> {
    if !(gap.is_finite() && gap >= 0.0) {
        return Err(Error::refused(format!("`gap` is {gap}; it must be zero or positive")));
    }
    match radii.iter().position(|radius| !(radius.is_finite() && *radius > 0.0)) {
        Some(body) => Err(Error::refused(format!("body {body} has radius {}; it must be positive", radii[body]))),
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
            return Err(Error::refused(format!(
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
    let fitting = (radii.len() as f64 * power::<D>(scale)).floor();
    let largest_gap = 2.0 * (scale * swollen - 1.0);
    let remedy = if reached == 0.0 {
        "place fewer bodies, lower `gap`, or enlarge `size`".to_string()
    } else if largest_gap > 0.0 {
        format!("lower `gap` below {largest_gap:.4}, or fill less than {reached:.3}: about {fitting} bodies")
    } else {
        let without_gap = reached * power::<D>(swollen);
        format!("fill less than {reached:.3}: about {fitting} bodies, or less than {without_gap:.3} with a `gap` of 0")
    };
    Error::refused(format!(
        "{} bodies that fill a fraction of {asked:.3} ({:.3} with their `gap` of {gap} counted) did not \
         fit into the box: the search reached a fraction of {reached:.3} with this gap; {remedy}",
        radii.len(),
        asked * power::<D>(swollen),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, first_fault, near_pairs, near_walls};

    fn cube<const D: usize>(walled: bool) -> Domain<D> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        Domain { size: SVector::repeat(1.0), axes: [if walled { wall } else { Axis::Periodic }; D] }
    }

    /// Bodies of two groups may differ in more than their radius.
    #[test]
    fn numbers_say_nothing_about_places_among_many_bodies() {
        let radii = equal::<2>(20_000, 0.3);
        let centers = pack(&cube(false), &[], &radii, 0.02, 1).unwrap();
        let (first, second) = centers.split_at(10_000);
        for axis in 0..2 {
            let mean = |centers: &[SVector<f64, 2>]| centers.iter().map(|center| center[axis]).sum::<f64>() / centers.len() as f64;
            // by chance they differ by 0.29 sqrt(2 / 10,000)
            assert!((mean(first) - mean(second)).abs() < 0.02, "{} and {}", mean(first), mean(second));
        }
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
    fn disks_pack_up_to_three_quarters() {
        for walled in [false, true] {
            assert_packed(&cube::<2>(walled), &[], &equal::<2>(400, 0.4), 0.1, 1);
            assert_packed(&cube::<2>(walled), &[], &equal::<2>(400, 0.75), 0.01, 2);
        }
    }

    #[test]
    fn spheres_pack_up_to_fifty_five_percent() {
        for walled in [false, true] {
            assert_packed(&cube::<3>(walled), &[], &equal::<3>(64, 0.3), 0.1, 1);
            assert_packed(&cube::<3>(walled), &[], &equal::<3>(200, 0.55), 0.01, 2);
        }
    }

    #[test]
    fn large_and_small_disks_pack_around_obstacles() {
        let obstacle = |x, y| Ball { center: [x, y].into(), radius: 0.15 };
        let radii: Vec<_> = (0..200).map(|body| if body < 3 { 0.1 } else { 0.01 }).collect();
        let obstacles = [obstacle(0.0, 0.5), obstacle(0.6, 0.9)];
        assert_packed(&cube::<2>(true), &obstacles[1..], &radii, 0.05, 3);
        assert_packed(&cube::<2>(false), &obstacles, &radii, 0.05, 3);
    }

    #[test]
    fn a_body_may_fill_its_box() {
        assert_packed(&cube::<2>(true), &[], &[0.5], 0.0, 1);
        assert_packed(&cube::<3>(false), &[], &[0.5], 0.0, 1);
    }

    #[test]
    fn the_seed_alone_decides() {
        let packed = |seed| pack(&cube::<2>(false), &[], &equal::<2>(50, 0.5), 0.1, seed).unwrap();
        assert_eq!(packed(1), packed(1));
        assert_ne!(packed(1), packed(2));
        assert!(pack(&cube::<2>(false), &[], &[], 0.1, 1).unwrap().is_empty());
    }

    #[test]
    fn bodies_wider_than_the_box_are_refused() {
        let refusal = |walled, radius| pack(&cube::<2>(walled), &[], &[0.1, radius], 0.1, 1).unwrap_err().to_string();
        assert!(refusal(false, 0.48).contains("body 1 of radius 0.48 overlaps its own periodic image"));
        assert!(refusal(true, 0.46).contains("does not fit between the walls"));
        assert!(refusal(true, f64::NAN).contains("must be positive"));
    }

    #[test]
    fn a_crowd_too_dense_is_refused_with_what_was_reached() {
        let (domain, radii) = (cube::<2>(false), equal::<2>(50, 0.95));
        let mut search = Search::new(Peers::Alone, &domain, &[], &radii, 0.01, 1);
        search.packing.effort = 10_000_000;
        let message = refusal(&domain, &radii, 0.01, search.run().unwrap_err()).to_string();
        assert!(message.starts_with("50 bodies that fill a fraction of 0.950 (0.960 with"), "{message}");
        assert!(
            message.contains("reached a fraction of 0.8") && message.contains("fill less than 0.8") && message.contains(": about 4"),
            "{message}"
        );
    }
}
