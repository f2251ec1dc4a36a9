//! Near pairs: which surfaces lie within reach of each other, periodic images included.

use std::cmp::Ordering;

use nalgebra::SVector;

use super::cells::{Cells, Member};
use super::{Ball, Domain};

/// Two balls near each other, or a ball near its own periodic image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<const D: usize> {
    /// The ball with the smaller index.
    pub first: usize,
    /// The other ball; equal to `first` for a ball and its own image.
    pub second: usize,
    /// From the centre of `first` to the centre of the image of `second`.
    pub separation: SVector<f64, D>,
    /// Distance between the surfaces, negative when they overlap.
    pub gap: f64,
}

/// A ball near a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallPair<const D: usize> {
    /// The ball.
    pub body: usize,
    /// Axis the wall is normal to.
    pub axis: usize,
    /// Whether the wall is the one at coordinate `size` rather than 0.
    pub upper: bool,
    /// Distance between the surfaces, negative when they overlap.
    pub gap: f64,
}

/// All pairs of balls with a gap below `reach`, by a cell list.
///
/// Distinct periodic images of one pair are distinct pairs. A ball and its own image count once for
/// each two opposite images: the one whose first nonzero component of the separation is positive.
/// Sorted by `first`, `second` and separation.
pub fn near_pairs<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64) -> Vec<Pair<D>> {
    let mut pairs = Vec::new();
    visit_near_pairs(domain, balls, reach, |pair| pairs.push(pair));
    pairs.sort_unstable_by(order);
    pairs
}

/// Shows each of [`near_pairs`] once, in no order and without keeping them.
pub fn visit_near_pairs<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64, mut visit: impl FnMut(Pair<D>)) {
    let cells = Cells::new(domain, balls);
    for member in cells.members() {
        let ball = member.ball;
        cells.visit(ball.center, 2.0 * ball.radius + reach, |other, image, separation| {
            if belongs(member, other, image) {
                let gap = separation.norm() - ball.radius - other.ball.radius;
                if gap < reach {
                    visit(ordered_pair(member.body, other.body, separation, gap));
                }
            }
        });
    }
}

/// All balls with a gap below `reach` to a wall, sorted by body and axis, lower wall first.
pub fn near_walls<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64) -> Vec<WallPair<D>> {
    let walled: Vec<usize> = (0..D).filter(|&axis| !domain.periodic(axis)).collect();
    let mut pairs = Vec::new();
    for (body, ball) in balls.iter().enumerate() {
        for &axis in &walled {
            let below = ball.center[axis] - ball.radius;
            let above = domain.size[axis] - ball.center[axis] - ball.radius;
            for (upper, gap) in [(false, below), (true, above)] {
                if gap < reach {
                    pairs.push(WallPair { body, axis, upper, gap });
                }
            }
        }
    }
    pairs
}

/// Whether the first of two balls is the one that reports the pair: the larger, or else the later.
fn belongs<const D: usize>(one: &Member<D>, other: &Member<D>, image: [isize; D]) -> bool {
    if one.body == other.body {
        return image > [0; D];
    }
    let (radius, other_radius) = (one.ball.radius, other.ball.radius);
    other_radius < radius || (other_radius == radius && other.body < one.body)
}

fn ordered_pair<const D: usize>(body: usize, other: usize, separation: SVector<f64, D>, gap: f64) -> Pair<D> {
    Pair { first: body.min(other), second: body.max(other), separation: if body <= other { separation } else { -separation }, gap }
}

fn order<const D: usize>(one: &Pair<D>, two: &Pair<D>) -> Ordering {
    (one.first, one.second).cmp(&(two.first, two.second)).then_with(|| {
        (0..D).map(|axis| one.separation[axis].total_cmp(&two.separation[axis])).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, LeesEdwards};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn domain<const D: usize>(size: [f64; D], periodic: [bool; D]) -> Domain<D> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        Domain { size: SVector::from(size), axes: periodic.map(|periodic| if periodic { Axis::Periodic } else { wall }) }
    }

    fn random_balls<const D: usize>(domain: &Domain<D>, count: usize, radii: [f64; 2], seed: u64) -> Vec<Ball<D>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count)
            .map(|_| Ball {
                center: SVector::from_fn(|axis, _| random.random::<f64>() * domain.size[axis]),
                radius: radii[0] + (radii[1] - radii[0]) * random.random::<f64>().powi(4),
            })
            .collect()
    }

    /// Every image within three boxes, every pair.
    fn brute_force<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64) -> Vec<Pair<D>> {
        let mut pairs = Vec::new();
        for flat in 0..7usize.pow(D as u32) {
            let image: [i32; D] = std::array::from_fn(|axis| (flat / 7usize.pow(axis as u32) % 7) as i32 - 3);
            if (0..D).any(|axis| image[axis] != 0 && !domain.periodic(axis)) {
                continue;
            }
            let offset = domain.offset(image.map(|boxes| boxes as isize));
            for first in 0..balls.len() {
                for second in first..balls.len() {
                    if first == second && image <= [0; D] {
                        continue;
                    }
                    let separation = balls[second].center + offset - balls[first].center;
                    let gap = separation.norm() - balls[first].radius - balls[second].radius;
                    if gap < reach {
                        pairs.push(Pair { first, second, separation, gap });
                    }
                }
            }
        }
        pairs.sort_unstable_by(order);
        pairs
    }

    fn assert_same<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64) {
        let found = near_pairs(domain, balls, reach);
        let expected = brute_force(domain, balls, reach);
        assert_eq!(found.len(), expected.len());
        for (one, two) in found.iter().zip(&expected) {
            assert_eq!((one.first, one.second), (two.first, two.second));
            assert!((one.separation - two.separation).norm() < 1e-12);
            assert!((one.gap - two.gap).abs() < 1e-12);
        }
    }

    #[test]
    fn cells_find_what_brute_force_finds_among_disks() {
        for seed in 0..20 {
            for periodic in [[true, true], [true, false], [false, false]] {
                let domain = domain([3.0, 1.7], periodic);
                assert_same(&domain, &random_balls(&domain, 60, [0.02, 0.4], seed), 0.1);
                assert_same(&domain, &random_balls(&domain, 60, [0.05, 0.05], seed), 0.01);
                assert_same(&domain, &random_balls(&domain, 40, [0.02, 0.4], seed), -0.03);
            }
        }
    }

    #[test]
    fn cells_find_what_brute_force_finds_among_spheres() {
        for seed in 0..10 {
            for periodic in [[true, true, true], [true, false, true]] {
                let domain = domain([2.0, 1.0, 1.3], periodic);
                assert_same(&domain, &random_balls(&domain, 40, [0.02, 0.4], seed), 0.1);
            }
        }
    }

    #[test]
    fn narrow_boxes_show_bodies_and_their_own_images() {
        for count in 1..6 {
            for seed in 0..20 {
                let domain = domain([1.0, 1.3], [true, true]);
                let balls = random_balls(&domain, count, [0.3, 0.55], seed);
                assert_same(&domain, &balls, 1.0);
                assert_same(&domain, &balls, 0.2);
            }
        }
    }

    #[test]
    fn images_that_slide_are_found_where_they_are() {
        for (seed, start) in [-1.4, -0.3, 0.2, 0.9, 1.5].into_iter().enumerate() {
            let axis = Axis::Sheared(LeesEdwards::steady(start, 0.0, 0.0));
            let flat = Domain { size: [3.0, 1.7].into(), axes: [Axis::Periodic, axis] };
            assert_same(&flat, &random_balls(&flat, 60, [0.02, 0.4], seed as u64), 0.1);
            assert_same(&flat, &random_balls(&flat, 3, [0.3, 0.7], seed as u64), 0.5);
            let deep = Domain {
                size: [3.0, 1.0, 1.3].into(),
                axes: [Axis::Periodic, Axis::Sheared(LeesEdwards::steady(start, 0.0, 0.0)), Axis::Periodic],
            };
            assert_same(&deep, &random_balls(&deep, 40, [0.02, 0.4], seed as u64), 0.1);
        }
    }

    #[test]
    fn a_ball_sees_each_of_its_images_once() {
        let domain = domain([1.0, 1.0], [true, true]);
        let ball = Ball { center: SVector::from([0.2, 0.9]), radius: 0.45 };
        let pairs = near_pairs(&domain, &[ball], 0.2);
        let separations: Vec<_> = pairs.iter().map(|pair| pair.separation).collect();
        let expected: [SVector<f64, 2>; 2] = [[0.0, 1.0].into(), [1.0, 0.0].into()];
        assert_eq!(separations, expected);
    }

    #[test]
    fn centers_outside_the_box_are_paired_all_the_same() {
        let domain = domain([3.0, 1.0], [true, false]);
        let ball = |x, y| Ball { center: SVector::from([x, y]), radius: 0.3 };
        let pairs = near_pairs(&domain, &[ball(-0.1, -0.7), ball(6.2, -0.9)], 0.1);
        assert_eq!(pairs.len(), 1);
        assert!((pairs[0].separation - SVector::from([0.3, -0.2])).norm() < 1e-12);
    }

    #[test]
    fn walls_are_near_bodies_that_are_near_walls() {
        let domain = domain([1.0, 1.0], [true, false]);
        let ball = |y, radius| Ball { center: SVector::from([0.01, y]), radius };
        let pairs = near_walls(&domain, &[ball(0.5, 0.45), ball(0.9, 0.2)], 0.1);
        let places: Vec<_> = pairs.iter().map(|pair| (pair.body, pair.axis, pair.upper)).collect();
        assert_eq!(places, [(0, 1, false), (0, 1, true), (1, 1, true)]);
        assert!((pairs[2].gap + 0.1).abs() < 1e-15);
    }
}
