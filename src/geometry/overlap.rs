//! Faults of a configuration: what no set of rigid balls in the box may do.

use std::fmt;

use super::{Ball, Domain, near_pairs};

/// Overlaps below this many radii are rounding.
const TOLERANCE: f64 = 1e-9;

/// The reason why a set of balls cannot be where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
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

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::Overlap { first, second, gap } => {
                write!(formatter, "bodies {first} and {second} overlap by {:.3e}", -gap)
            }
            Fault::OwnImage { body, gap } => {
                write!(formatter, "body {body} overlaps its own periodic image by {:.3e}", -gap)
            }
            Fault::Outside { body, axis } => {
                write!(formatter, "body {body} leaves the box along axis {axis}")
            }
        }
    }
}

/// The first fault of a configuration, if any: bodies outside the box by index and axis, then overlaps
/// in the order of [`near_pairs`].
///
/// Centres may lie anywhere in `[0, size]` along periodic axes; balls must lie between walls.
pub fn first_fault<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<Fault> {
    outside(domain, balls).or_else(|| overlap(domain, balls))
}

fn outside<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<Fault> {
    let places = (0..balls.len()).flat_map(|body| (0..D).map(move |axis| (body, axis)));
    let is_outside = |&(body, axis): &(usize, usize)| {
        let ball = &balls[body];
        let margin = if domain.periodic(axis) { 0.0 } else { ball.radius };
        let slack = TOLERANCE * ball.radius;
        let allowed = margin - slack..=domain.size[axis] - margin + slack;
        !allowed.contains(&ball.center[axis])
    };
    places.into_iter().find(is_outside).map(|(body, axis)| Fault::Outside { body, axis })
}

fn overlap<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>]) -> Option<Fault> {
    near_pairs(domain, balls, 0.0)
        .into_iter()
        .find(|pair| {
            let slack = TOLERANCE * balls[pair.first].radius.min(balls[pair.second].radius);
            pair.gap < -slack
        })
        .map(|pair| match pair.first == pair.second {
            true => Fault::OwnImage { body: pair.first, gap: pair.gap },
            false => Fault::Overlap { first: pair.first, second: pair.second, gap: pair.gap },
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;
    use nalgebra::SVector;

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
            Some(Fault::Overlap { first: 0, second: 2, gap }) => assert!((gap + 0.1).abs() < 1e-12),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_ball_wider_than_the_box_overlaps_its_image() {
        let mut domain = channel();
        domain.size[0] = 0.7;
        let fault = first_fault(&domain, &[ball(0.1, 0.5, 0.4)]);
        assert!(matches!(fault, Some(Fault::OwnImage { body: 0, .. })), "{fault:?}");
    }

    #[test]
    fn a_ball_in_a_wall_or_a_center_outside_the_box_is_found() {
        let good = ball(1.0, 0.5, 0.2);
        let outside = |bad, axis| {
            assert_eq!(first_fault(&channel(), &[good, bad]), Some(Fault::Outside { body: 1, axis }));
        };
        outside(ball(0.3, 0.19, 0.2), 1);
        outside(ball(2.1, 0.5, 0.2), 0);
        outside(ball(0.3, f64::NAN, 0.2), 1);
    }
}
