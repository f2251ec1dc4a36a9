//! The resistance at any gap, from resistances at gaps that the highest order of modes resolves.
//!
//! The part that is singular as the gap `e` closes is known; what is left is smooth in `sqrt(e)` (2D) or in `e` and `e ln e` (3D)
//! and is fitted by least squares. In 2D Reynolds' equation in a gap `h = e + x^2/(2 r)`, `1/r = 1/a_1 + 1/a_2`, gives (unit viscosity)
//!
//! ```text
//! approach  3 sqrt(2) pi (r/e)^{3/2}        slip  pi sqrt(2 r/e) + c d^2/16      cross  c d/8      roll  c/4
//! c = 4 pi (2 r)^{5/2} / sqrt(e)            d = 1/a_2 - 1/a_1
//! ```
//!
//! and in 3D the approach of spheres is (Jeffrey and Onishi 1984, doi:10.1017/S0022112084000355)
//!
//! ```text
//! 6 pi (g_1/x + g_2 ln(1/x) + g_3 x ln(1/x))        x = 2 e/(a_1 + a_2),  k = a_2/a_1
//! g_1 = 2 k^2/(1+k)^3    g_2 = k (1 + 7k + k^2)/(5 (1+k)^3)    g_3 = (1 + 18k - 29k^2 + 18k^3 + k^4)/(42 (1+k)^3)
//! ```
//!
//! Singular forces act at the gap, and so tell the singular stress and the singular pressure on bodies.

use std::{
    f64::consts::{PI, SQRT_2},
    rc::Rc,
};

use nalgebra::{DMatrix, DVector};

use super::{NUMBERS, Resistance};

/// Resistance as a function of the gap; lengths in radii of the first body.
#[derive(Clone)]
pub struct Exact {
    dimension: usize,
    /// Radius of the second body, none for a wall.
    second: Option<f64>,
    coefficients: Vec<DVector<f64>>,
}

impl Exact {
    /// The function through resistances at several gaps.
    pub fn fit(dimension: usize, second: Option<f64>, samples: &[(f64, Resistance)]) -> Exact {
        let mut exact = Exact { dimension, second, coefficients: Vec::new() };
        let known: Vec<Resistance> = samples.iter().map(|(gap, _)| exact.singular(*gap)).collect();
        for number in 0..NUMBERS {
            let functions: Vec<Vec<f64>> = samples.iter().map(|(gap, _)| exact.functions(number, *gap)).collect();
            let found: Vec<f64> = samples.iter().map(|(_, found)| found.numbers()[number]).collect();
            let weight = |row: usize| 1.0 / (1.0 + found[row].abs());
            let matrix = DMatrix::from_fn(samples.len(), functions[0].len(), |row, column| weight(row) * functions[row][column]);
            let values = DVector::from_fn(samples.len(), |row, _| weight(row) * (found[row] - known[row].numbers()[number]));
            exact.coefficients.push(matrix.svd(true, true).solve(&values, 1e-13).expect("both factors were asked for"));
        }
        exact
    }

    /// For a second body of some radius, from functions for others: what is not singular is their mean.
    pub fn mean(radius: f64, parts: &[(Rc<Exact>, f64)]) -> Exact {
        let [(first, _), ..] = parts else { unreachable!("there are parts") };
        let sum = |number: usize| parts.iter().map(|(part, weight)| &part.coefficients[number] * *weight).sum();
        Exact { dimension: first.dimension, second: Some(radius), coefficients: (0..NUMBERS).map(sum).collect() }
    }

    /// The resistance at a gap above zero.
    pub fn at(&self, gap: f64) -> Resistance {
        let smooth = |number: usize| self.functions(number, gap).iter().zip(self.coefficients[number].iter()).map(|(f, c)| f * c).sum();
        Resistance::of(std::array::from_fn(smooth)).with(&self.singular(gap), |smooth, singular| smooth + singular)
    }

    /// What is known beforehand.
    fn singular(&self, gap: f64) -> Resistance {
        let [approach, slip, cross, roll] = if self.dimension == 2 { self.plane(gap) } else { [self.spheres(gap), 0.0, 0.0, 0.0] };
        let second = self.second.unwrap_or(0.0);
        let deviator = 1.0 - 1.0 / self.dimension as f64;
        let stress = [
            [-deviator * approach, -deviator * second * approach],
            [0.5 * (cross - slip), -0.5 * (second * slip + cross)],
            [0.5 * (roll - cross), -0.5 * (second * cross + roll)],
        ];
        let seen = |[first, other]: [f64; 2]| [first, if self.second.is_some() { other } else { 0.0 }];
        Resistance { approach, slip, cross, roll, stress: stress.map(seen), pressure: [approach, second * approach] }
    }

    fn plane(&self, gap: f64) -> [f64; 4] {
        let curvature = self.second.map_or(0.0, |radius| 1.0 / radius);
        let reduced = 1.0 / (1.0 + curvature);
        let (pressure, difference) = (4.0 * PI * (2.0 * reduced).powf(2.5) / gap.sqrt(), curvature - 1.0);
        [
            3.0 * SQRT_2 * PI * (reduced / gap).powf(1.5),
            PI * (2.0 * reduced / gap).sqrt() + pressure * difference.powi(2) / 16.0,
            pressure * difference / 8.0,
            pressure / 4.0,
        ]
    }

    fn spheres(&self, gap: f64) -> f64 {
        let Some(ratio) = self.second else {
            // the limit of a large second sphere
            return 6.0 * PI * (1.0 / gap - gap.ln() / 5.0 - gap * gap.ln() / 21.0);
        };
        let (x, cube) = (2.0 * gap / (1.0 + ratio), (1.0 + ratio).powi(3));
        let first = 2.0 * ratio.powi(2) / cube;
        let second = ratio * (1.0 + 7.0 * ratio + ratio.powi(2)) / (5.0 * cube);
        let third = (1.0 + 18.0 * ratio - 29.0 * ratio.powi(2) + 18.0 * ratio.powi(3) + ratio.powi(4)) / (42.0 * cube);
        6.0 * PI * (first / x - (second + third * x) * x.ln())
    }

    /// The functions whose sum is what is left of a number.
    fn functions(&self, number: usize, gap: f64) -> Vec<f64> {
        let approach = Resistance::of_approach(number);
        if self.dimension == 2 {
            let powers: Vec<i32> = if approach { (-1..12).step_by(2).collect() } else { (0..8).collect() };
            return powers.into_iter().map(|power| gap.sqrt().powi(power)).collect();
        }
        let log = gap.ln();
        let smooth = [1.0, gap * log, gap, gap * gap * log, gap * gap, gap.powi(3)];
        if number == 0 { smooth.to_vec() } else { [&[log], &smooth[..]].concat() }
    }
}
