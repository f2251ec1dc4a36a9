//! Gaps that are too thin for the modes of the inclusions around them.
//!
//! Between two balls, or a ball and its image in a wall, fields fall in a ball of radius `a` by `e^-alpha` from one mode to the next, and what they add to
//! fluxes by the square of that, with
//!
//! ```text
//! a sinh(alpha) = c,   4 d^2 c^2 = (d^2 - a_1^2 - a_2^2)^2 - 4 a_1^2 a_2^2,   of a wall at h from the centre c^2 = h^2 - a^2
//! ```
//!
//! and the distance `d` of the centres. Of two equal balls `cosh(alpha) = 1 + g / 2` with their gap `g` in radii.

use super::ScalarSetup;
use crate::{
    geometry::{Ball, near_pairs, near_walls},
    scene::ConstraintMethod,
};

/// What `alpha (K + 1)` is where conductivity is off by some 1 % and the first mode left out is `K + 1`: for square arrays of disks 2.34 to 2.38 with gaps of
/// 0.004 to 0.13 radii, and 2.1 with one of 0.22.
const RESOLVED: f64 = 2.3;

/// A gap that is thinner than modes resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinGap {
    /// The gap in radii of the smaller of the two.
    pub gap: f64,
    /// The highest mode of the one that resolves it less.
    pub modes: usize,
    /// How well it is resolved: `alpha (K + 1)`.
    measure: f64,
}

impl ThinGap {
    /// The least order of modes that would resolve it.
    pub fn resolving_modes(&self) -> usize {
        ((self.modes + 1) as f64 * RESOLVED / self.measure).ceil() as usize - 1
    }
}

impl<const D: usize> ScalarSetup<D> {
    /// The gap that modes resolve least, images and walls included, if conductivity is off by 1 % or more for it; nothing where multipliers are no modes.
    pub fn thin_gap(&self) -> Option<ThinGap> {
        if !matches!(self.constraint, ConstraintMethod::Sharp | ConstraintMethod::MeanValue(_)) {
            return None;
        }
        let balls: Vec<Ball<D>> = self.inclusions.iter().map(|(ball, _)| Ball { center: self.domain.wrap(ball.center), ..*ball }).collect();
        let reach = self.reach()?;
        let pairs = near_pairs(&self.domain, &balls, reach).into_iter().map(|pair| {
            let [one, other] = [pair.first, pair.second].map(|body| balls[body].radius);
            let (squares, distance) = ([one * one, other * other], one + other + pair.gap);
            let square =
                ((distance * distance - squares[0] - squares[1]).powi(2) - 4.0 * squares[0] * squares[1]) / (4.0 * distance * distance);
            self.seen(&[pair.first, pair.second], pair.gap, square)
        });
        let walls = near_walls(&self.domain, &balls, reach).into_iter().map(|pair| {
            let square = pair.gap * (2.0 * balls[pair.body].radius + pair.gap);
            self.seen(&[pair.body], pair.gap, square)
        });
        pairs.chain(walls).filter(|gap| gap.measure < RESOLVED).min_by(|one, other| one.measure.total_cmp(&other.measure))
    }

    /// The widest gap that may be unresolved: `c^2` is at least the gap times the smaller radius.
    fn reach(&self) -> Option<f64> {
        let radii = || self.inclusions.iter().map(|(ball, _)| ball.radius);
        let (least, most) = (radii().reduce(f64::min)?, radii().reduce(f64::max)?);
        let modes = self.inclusions.iter().map(|(_, modes)| *modes).min()?;
        Some((most * (RESOLVED / (modes + 1) as f64).sinh()).powi(2) / least)
    }

    /// A gap of inclusions with the square of its `c`, which rounding of touching balls may make negative.
    fn seen(&self, inclusions: &[usize], gap: f64, square: f64) -> ThinGap {
        let smallest = inclusions.iter().map(|&inclusion| self.inclusions[inclusion].0.radius).fold(f64::INFINITY, f64::min);
        let of = |&inclusion: &usize| {
            let (ball, modes) = self.inclusions[inclusion];
            let measure = (square.max(f64::MIN_POSITIVE).sqrt() / ball.radius).asinh() * (modes + 1) as f64;
            ThinGap { gap: gap / smallest, modes, measure }
        };
        inclusions.iter().map(of).min_by(|one, other| one.measure.total_cmp(&other.measure)).expect("a gap is at an inclusion")
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::{
        geometry::{Axis, Domain},
        scene::Tolerance,
    };

    fn array(radii: &[(f64, usize)]) -> ScalarSetup<2> {
        let place = |number: usize| Vector2::new(0.5 + number as f64, 0.5);
        let inclusions =
            radii.iter().enumerate().map(|(number, &(radius, modes))| (Ball { center: place(number), radius }, modes)).collect();
        ScalarSetup {
            domain: Domain { size: Vector2::new(radii.len() as f64, 1.0), axes: [Axis::Periodic; 2] },
            spacing: 0.01,
            source: 0.0,
            gradient: Some(Vector2::x()),
            inclusions,
            constraint: ConstraintMethod::Sharp,
            tolerance: Tolerance::Fixed(1e-9),
        }
    }

    /// Errors of the conductivity of square arrays, of which even modes are no part, by Rayleigh's method with 60 to 600 modes.
    #[test]
    fn square_arrays_are_warned_of_from_an_error_of_one_percent_on() {
        let cases = [
            (0.4999, [(16, 0.64), (32, 0.38)]),
            (0.499, [(32, 0.019), (24, 0.057)]),
            (0.497, [(24, 0.0044), (16, 0.029)]),
            (0.49, [(12, 0.0054), (8, 0.033)]),
            (0.47, [(6, 0.0080), (4, 0.029)]),
            (0.45, [(6, 0.0016), (4, 0.0066)]),
        ];
        for (radius, errors) in cases {
            for (modes, error) in errors {
                let found = array(&[(radius, modes)]).thin_gap();
                assert_eq!(found.is_some(), error > 0.01, "{radius}, {modes} modes, error {error}: {found:?}");
                assert!(found.is_none_or(|found| (found.gap - (1.0 - 2.0 * radius) / radius).abs() < 1e-9 && found.modes == modes));
            }
        }
    }

    #[test]
    fn walls_and_unequal_disks_have_gaps_too() {
        // a disk and its image in a wall at half the gap
        let mut walled = array(&[(0.499, 24)]);
        walled.domain.axes[1] = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
        walled.inclusions[0].0.center.x = 0.3;
        assert!(walled.thin_gap().is_some());
        walled.inclusions[0].1 = 32;
        walled.domain.size.x = 3.0;
        let found = walled.thin_gap().expect("it is thin");
        assert!((found.gap - 0.001 / 0.499).abs() < 1e-9, "{found:?}");
        // the larger of two disks resolves a gap less than the smaller
        let mut unequal = array(&[(0.4, 12), (0.2, 12)]);
        unequal.inclusions[1].0.center.x = 0.5 + 0.6 + 0.002;
        let found = unequal.thin_gap().expect("it is thin");
        assert!((found.gap - 0.01).abs() < 1e-9, "{found:?}");
        let needed = found.resolving_modes();
        unequal.inclusions.iter_mut().for_each(|(_, modes)| *modes = needed);
        assert_eq!(unequal.thin_gap(), None);
        unequal.inclusions[0].1 = needed - 1;
        assert!(unequal.thin_gap().is_some());
        unequal.constraint = ConstraintMethod::Distributed;
        assert_eq!(unequal.thin_gap(), None);
    }
}
