//! Boxes along the axes, and whether they meet in a periodic domain.

use nalgebra::SVector;

use super::{Ball, Domain};
use crate::linalg::ROUNDING;

/// A box along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds<const D: usize> {
    lower: SVector<f64, D>,
    upper: SVector<f64, D>,
}

impl<const D: usize> Bounds<D> {
    /// The box around a ball, in the image next to a place.
    pub fn of(domain: &Domain<D>, ball: &Ball<D>, place: &SVector<f64, D>) -> Bounds<D> {
        let center = place + domain.nearest_image(ball.center - place);
        let radius = SVector::repeat(ball.radius);
        Bounds { lower: center - radius, upper: center + radius }
    }

    /// The smallest box around others, or one that meets nothing.
    pub fn around(all: &[Bounds<D>]) -> Bounds<D> {
        let nothing = Bounds { lower: SVector::repeat(f64::INFINITY), upper: SVector::repeat(f64::NEG_INFINITY) };
        all.iter().fold(nothing, |sum, one| Bounds { lower: sum.lower.inf(&one.lower), upper: sum.upper.sup(&one.upper) })
    }

    /// It as numbers.
    pub fn numbers(&self) -> Vec<f64> {
        [self.lower.as_slice(), self.upper.as_slice()].concat()
    }

    /// What [`numbers`](Self::numbers) gave.
    pub fn read(numbers: &[f64]) -> Bounds<D> {
        Bounds { lower: SVector::from_column_slice(&numbers[..D]), upper: SVector::from_column_slice(&numbers[D..]) }
    }

    /// Whether an image of this box meets another one.
    pub fn meets(&self, other: &Bounds<D>, domain: &Domain<D>) -> bool {
        if other.lower > other.upper {
            return false;
        }
        let slack = domain.size.max() * ROUNDING;
        // the least number of boxes by which an image lies above the lower end of the other
        let least = |axis: usize, aside: f64| ((other.lower[axis] - slack - self.upper[axis] - aside) / domain.size[axis]).ceil();
        let below = |axis: usize, moved: f64| self.lower[axis] + moved <= other.upper[axis] + slack;
        let along = |axis: usize, aside: f64| match domain.periodic(axis) {
            true => below(axis, aside + least(axis, aside) * domain.size[axis]),
            false => below(axis, 0.0) && self.upper[axis] >= other.lower[axis] - slack,
        };
        if (2..D).any(|axis| !along(axis, 0.0)) {
            return false;
        }
        if !domain.periodic(1) {
            return along(0, 0.0) && along(1, 0.0);
        }
        let mut row = least(1, 0.0);
        while below(1, row * domain.size[1]) {
            if along(0, row * domain.shift()) {
                return true;
            }
            row += 1.0;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Axis, LeesEdwards};

    fn bounds(x: [f64; 2], y: [f64; 2]) -> Bounds<2> {
        Bounds { lower: SVector::from([x[0], y[0]]), upper: SVector::from([x[1], y[1]]) }
    }

    #[test]
    fn boxes_meet_those_whose_images_they_touch() {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let slide = |start| Axis::Sheared(LeesEdwards::steady(start, 0.0, 0.0));
        let domain = |axes| Domain { size: SVector::from([10.0, 4.0]), axes };
        let (low, high) = (bounds([0.0, 1.0], [0.0, 1.0]), bounds([9.5, 10.5], [3.5, 4.5]));
        assert!(high.meets(&low, &domain([Axis::Periodic; 2])) && low.meets(&high, &domain([Axis::Periodic; 2])));
        assert!(!high.meets(&low, &domain([Axis::Periodic, wall])));
        assert!(!high.meets(&low, &domain([wall, Axis::Periodic])));
        // the image below lies to the left by the shift
        for (start, expected) in [(0.0, true), (5.0, false), (9.9, true), (-0.4, true), (2.0, false)] {
            assert_eq!(high.meets(&low, &domain([Axis::Periodic, slide(start)])), expected, "{start}");
            assert_eq!(low.meets(&high, &domain([Axis::Periodic, slide(start)])), expected, "{start}");
        }
        assert!(!low.meets(&Bounds::around(&[]), &domain([Axis::Periodic; 2])));
        let wide = bounds([-30.0, 30.0], [-9.0, 9.0]);
        assert!(wide.meets(&low, &domain([Axis::Periodic, slide(3.0)])));
    }
}
