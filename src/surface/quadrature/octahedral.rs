//! A rule on the unit sphere with the symmetry of the cube, so that no axis is told from another.
//!
//! Points are the centres of `n x n` cells on each face of a cube, equal in angle, seen from its centre: `(1, tan s, tan t)/r`. Their weights begin as the
//! solid angles of the cells and are changed as little as possible until the mean of every polynomial up to a degree is exact. A polynomial
//! without the symmetry is integrated by the rule as its mean over the symmetries is, so that only invariant ones count: on the sphere the products
//! `(x^4 + y^4 + z^4)^i (x y z)^{2j}`, of degree `4i + 6j`.
//!
//! With degrees up to `2 n - 4` the means of fields that a near body causes are as exact as by Gauss-Legendre latitudes with a tenth more points; higher degrees make
//! weights uneven and the means worse.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::{Quadrature, sphere};

/// Largest error of a mean that counts as exact.
const EXACT: f64 = 5e-15;

/// The rule with at least `side` points along the side of a face, as many as it takes to be exact up to `degree` with positive weights.
pub fn rule(side: usize, degree: usize) -> Quadrature {
    let degrees = |side: usize| (0..=(2 * side).saturating_sub(4 + degree) / 2).rev().map(|more| degree + 2 * more);
    let orbits = |side: usize| degrees(side).find_map(|degree| Orbits::of(side).exact(degree)).map(|orbits| orbits.points(side));
    (side..).find_map(orbits).expect("fine rules are nearly exact as they are")
}

/// Points that the symmetries take to each other: one of them, and the weight of all.
struct Orbits {
    points: Vec<[f64; 3]>,
    weights: DVector<f64>,
}

impl Orbits {
    /// With the solid angles of the cells as parts of the whole.
    fn of(side: usize) -> Orbits {
        let half = side.div_ceil(2);
        let (mut points, mut weights) = (vec![[0.0; 3]; number(half - 1, half - 1) + 1], vec![0.0; number(half - 1, half - 1) + 1]);
        for first in 0..side {
            for second in 0..side {
                let (s, t) = (tangent(first, side), tangent(second, side));
                let square = 1.0 + s * s + t * t;
                let orbit = orbit(first, second, side);
                points[orbit] = [1.0, s, t].map(|x| x / square.sqrt());
                weights[orbit] += (1.0 + s * s) * (1.0 + t * t) / square.powf(1.5);
            }
        }
        let weights = DVector::from_vec(weights);
        Orbits { points, weights: &weights / weights.sum() }
    }

    /// With weights that are exact up to a degree, if there are such and all are positive.
    fn exact(mut self, degree: usize) -> Option<Orbits> {
        let powers: Vec<(i32, i32)> =
            (0..=degree / 4).flat_map(|i| (0..=(degree - 4 * i) / 6).map(move |j| (i as i32, j as i32))).collect();
        if powers.len() > self.points.len() {
            return None;
        }
        let means = means(&powers, degree);
        let values = DMatrix::from_fn(powers.len(), self.points.len(), |row, point| invariant(&self.points[point], powers[row]));
        // twice: the second time takes away what rounding left
        for _ in 0..2 {
            let roots = self.weights.map(f64::sqrt);
            let scaled = DMatrix::from_fn(values.nrows(), values.ncols(), |row, point| values[(row, point)] * roots[point]);
            let change = scaled.svd(true, true).solve(&(&means - &values * &self.weights), 1e-12).ok()?;
            self.weights += roots.component_mul(&change);
            if self.weights.min() <= 0.0 {
                return None;
            }
        }
        ((&values * &self.weights - means).amax() < EXACT).then_some(self)
    }

    /// All points, each with its part of the weight of its orbit.
    fn points(&self, side: usize) -> Quadrature {
        let places = || (0..side).flat_map(|first| (0..side).map(move |second| (first, second)));
        let mut sizes = vec![0.0; self.points.len()];
        places().for_each(|(first, second)| sizes[orbit(first, second, side)] += 6.0);
        let mut rule = Quadrature { directions: Vec::new(), weights: Vec::new() };
        for face in 0..6 {
            let (axis, height) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
            for (first, second) in places() {
                let (s, t) = (tangent(first, side), tangent(second, side));
                let mut point = [0.0; 3];
                (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (height, s, t);
                rule.directions.extend(point.map(|x| x / (1.0 + s * s + t * t).sqrt()));
                let orbit = orbit(first, second, side);
                rule.weights.push(self.weights[orbit] / sizes[orbit]);
            }
        }
        rule
    }
}

fn tangent(place: usize, side: usize) -> f64 {
    (PI * ((2 * place + 1) as f64 / (4 * side) as f64 - 0.25)).tan()
}

/// The orbit of a cell of a face.
fn orbit(first: usize, second: usize, side: usize) -> usize {
    let [first, second] = [first, second].map(|place| place.min(side - 1 - place));
    number(first.min(second), first.max(second))
}

fn number(smaller: usize, larger: usize) -> usize {
    larger * (larger + 1) / 2 + smaller
}

/// Means of invariant polynomials over the sphere.
fn means(powers: &[(i32, i32)], degree: usize) -> DVector<f64> {
    let rule = sphere(degree / 2 + 1, degree + 1);
    let points = || rule.directions.chunks(3).zip(&rule.weights);
    DVector::from_fn(powers.len(), |row, _| points().map(|(point, weight)| weight * invariant(point, powers[row])).sum())
}

/// A product of powers of the two invariants, over their range: between -1 and 1, and between 0 and 1.
fn invariant(point: &[f64], (i, j): (i32, i32)) -> f64 {
    let fourth: f64 = point.iter().map(|x| x.powi(4)).sum();
    let product: f64 = point.iter().product();
    (3.0 * fourth - 2.0).powi(i) * (27.0 * product * product).powi(j)
}
