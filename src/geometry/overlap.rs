//! Faults of a configuration: what no set of rigid balls in the box may do.

use super::{Ball, Domain, levels::Levels};

/// Overlaps below this many radii are rounding.
const TOLERANCE: f64 = 1e-9;

/// The reason why a set of balls cannot be where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InvalidConfiguration {
    /// Two balls overlap.
    Overlap {
        /// The ball with the smaller index.
        first: usize,
        /// The other ball.
        second: usize,
        /// Distance between the surfaces, negative.
        gap: f64,
    },
    /// A ball overlaps its own periodic image.
    OwnImage {
        /// The ball.
        body: usize,
        /// Distance between the surfaces, negative.
        gap: f64,
    },
    /// A centre lies outside the box, or a ball reaches into a wall.
    Outside {
        /// The ball.
        body: usize,
        /// Axis along which it leaves the box.
        axis: usize,
    },
}

/// The first fault of a configuration, if any: bodies outside the box by index and axis, then those wider than it, then the first
/// ball, from the largest down and by index, that overlaps one before it.
///
/// Centres may lie anywhere in `[0, size]` along periodic axes; balls must lie between walls. Its cost grows as the number of balls, up to
/// the first fault.
pub fn first_fault<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<InvalidConfiguration> {
    outside(domain, balls).or_else(|| own_image(domain, balls)).or_else(|| overlap(domain, balls))
}

fn outside<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<InvalidConfiguration> {
    let places = (0..balls.len()).flat_map(|body| (0..D).map(move |axis| (body, axis)));
    let is_outside = |&(body, axis): &(usize, usize)| {
        let ball = &balls[body];
        let margin = if domain.periodic(axis) { 0.0 } else { ball.radius };
        let slack = TOLERANCE * ball.radius;
        let allowed = margin - slack..=domain.size[axis] - margin + slack;
        !allowed.contains(&ball.center[axis])
    };
    places.into_iter().find(is_outside).map(|(body, axis)| InvalidConfiguration::Outside { body, axis })
}

fn own_image<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<InvalidConfiguration> {
    let images = (0..D).filter(|&axis| domain.periodic(axis)).map(|axis| {
        let mut next = domain.offset(std::array::from_fn(|other| isize::from(other == axis)));
        if axis == 1 && domain.periodic(0) {
            // images that slide lie aside by less than half a box
            next[0] -= domain.size[0] * (next[0] / domain.size[0]).round();
        }
        next.norm()
    });
    let nearest = images.fold(f64::INFINITY, f64::min);
    let gap = |ball: &Ball<D>| nearest - 2.0 * ball.radius;
    let body = balls.iter().position(|ball| gap(ball) < -TOLERANCE * ball.radius)?;
    Some(InvalidConfiguration::OwnImage { body, gap: gap(&balls[body]) })
}

fn overlap<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<InvalidConfiguration> {
    let mut order: Vec<usize> = (0..balls.len()).collect();
    order.sort_by(|&one, &two| balls[two].radius.total_cmp(&balls[one].radius));
    let mut levels = Levels::new(domain);
    for body in order {
        let mut fault: Option<(usize, f64)> = None;
        levels.visit(&balls[body], |other, distance| {
            let gap = distance - balls[body].radius - balls[other].radius;
            let slack = TOLERANCE * balls[body].radius.min(balls[other].radius);
            if gap < -slack && fault.is_none_or(|(first, least)| (other, gap) < (first, least)) {
                fault = Some((other, gap));
            }
        });
        if let Some((other, gap)) = fault {
            return Some(InvalidConfiguration::Overlap { first: body.min(other), second: body.max(other), gap });
        }
        levels.insert(body, &balls[body]);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, LeesEdwards, near_pairs};
    use nalgebra::SVector;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn channel() -> Domain<2> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        Domain { size: [2.0, 1.0].into(), axes: [Axis::Periodic, wall] }
    }

    fn ball(x: f64, y: f64, radius: f64) -> Ball<2> {
        Ball { center: [x, y].into(), radius }
    }

    #[test]
    fn balls_that_touch_are_no_fault() {
        let balls = [ball(0.5, 0.5, 0.5), ball(1.5, 0.5, 0.5)];
        assert_eq!(first_fault(&channel(), &balls), None);
    }

    #[test]
    fn an_overlap_across_the_periodic_side_is_found() {
        let balls = [ball(0.1, 0.5, 0.2), ball(1.0, 0.5, 0.2), ball(1.8, 0.5, 0.2)];
        match first_fault(&channel(), &balls) {
            Some(InvalidConfiguration::Overlap { first: 0, second: 2, gap }) => assert!((gap + 0.1).abs() < 1e-12),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_ball_wider_than_the_box_overlaps_its_image() {
        let mut domain = channel();
        domain.size[0] = 0.7;
        let fault = first_fault(&domain, &[ball(0.1, 0.5, 0.4)]);
        assert!(matches!(fault, Some(InvalidConfiguration::OwnImage { body: 0, .. })), "{fault:?}");
    }

    #[test]
    fn a_fault_is_found_where_pairs_overlap_and_nowhere_else() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let sheared = Axis::Sheared(LeesEdwards::steady(0.7, 0.0, 0.0));
        let mut found = [0, 0];
        for case in 0..2000 {
            let mut domain = channel();
            domain.axes[1] = if case % 2 == 0 { Axis::Periodic } else { sheared };
            let radius = |random: &mut ChaCha8Rng| 0.15 * random.random::<f64>().powi(4) + 0.001;
            let balls: Vec<Ball<2>> =
                (0..12).map(|_| ball(2.0 * random.random::<f64>(), random.random::<f64>(), radius(&mut random))).collect();
            let overlaps = near_pairs(&domain, &balls, 0.0).iter().any(|pair| pair.gap < -1e-9);
            assert_eq!(first_fault(&domain, &balls).is_some(), overlaps, "{balls:?}");
            found[usize::from(overlaps)] += 1;
        }
        assert!(found.iter().all(|&cases| cases > 200), "{found:?}");
    }

    #[test]
    fn crowds_that_cluster_or_coincide_are_told_soon() {
        let domain: Domain<2> = Domain { size: [1e6, 1e6].into(), axes: [Axis::Periodic; 2] };
        let same = vec![ball(1.0, 1.0, 0.5); 100_000];
        assert_eq!(first_fault(&domain, &same), Some(InvalidConfiguration::Overlap { first: 0, second: 1, gap: -1.0 }));
        let cluster: Vec<Ball<2>> = (0..100_000).map(|body| ball(f64::from(body % 300), f64::from(body / 300), 0.5)).collect();
        assert_eq!(first_fault(&domain, &cluster), None);
    }

    #[test]
    fn a_ball_in_a_wall_or_a_center_outside_the_box_is_found() {
        let good = ball(1.0, 0.5, 0.2);
        let outside = |bad, axis| {
            assert_eq!(first_fault(&channel(), &[good, bad]), Some(InvalidConfiguration::Outside { body: 1, axis }));
        };
        outside(ball(0.3, 0.19, 0.2), 1);
        outside(ball(2.1, 0.5, 0.2), 0);
        outside(ball(0.3, f64::NAN, 0.2), 1);
    }
}
