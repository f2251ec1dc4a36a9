//! A rule on the unit sphere with the symmetry of the cube, so that no axis is told from another.
//!
//! Points are the centres of `n x n` cells on each face of a cube, equal in angle, seen from its centre: `(1, tan s, tan t)/r`. Their weights begin as the
//! solid angles of the cells and are changed as little as possible until the mean of every polynomial up to a degree is exact. A polynomial
//! without the symmetry is integrated by the rule as its mean over the symmetries is, so that only invariant ones count: on the sphere the products
//! `(x^4 + y^4 + z^4)^i (x y z)^{2j}`, of degree `4i + 6j`.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::{Quadrature, sphere};

/// Largest error of a mean that counts as exact.
const EXACT: f64 = 5e-15;

/// The rule with at least `side` points along the side of a face, as many as it takes to be exact up to `degree` with positive weights.
pub fn rule(side: usize, degree: usize) -> Quadrature {
    let exact = means(&sphere(degree / 2 + 1, degree + 1), degree);
    let fitted = |side: usize| fit(cube(side), degree, &exact);
    (side..).find_map(fitted).expect("fine rules are nearly exact as they are")
}

/// The directions of all cells and their solid angles, as parts of the whole.
fn cube(side: usize) -> Quadrature {
    let tangents: Vec<f64> = (0..side).map(|place| (PI * ((2 * place + 1) as f64 / (4 * side) as f64 - 0.25)).tan()).collect();
    let mut rule = Quadrature { directions: Vec::new(), weights: Vec::new() };
    for face in 0..6 {
        let (axis, height) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
        for s in &tangents {
            for t in &tangents {
                let square = 1.0 + s * s + t * t;
                let mut point = [0.0; 3];
                (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (height, *s, *t);
                rule.directions.extend(point.map(|x| x / square.sqrt()));
                rule.weights.push((1.0 + s * s) * (1.0 + t * t) / square.powf(1.5));
            }
        }
    }
    let sum: f64 = rule.weights.iter().sum();
    rule.weights.iter_mut().for_each(|weight| *weight /= sum);
    rule
}

/// The rule with weights that are exact, if there are such and all are positive.
fn fit(mut rule: Quadrature, degree: usize, exact: &DVector<f64>) -> Option<Quadrature> {
    let values = values(&rule, degree);
    // twice: the second time takes away what rounding left
    for _ in 0..2 {
        let weights = DVector::from_column_slice(&rule.weights);
        let roots = weights.map(f64::sqrt);
        let scaled = DMatrix::from_fn(values.nrows(), values.ncols(), |row, point| values[(row, point)] * roots[point]);
        let change = scaled.svd(true, true).solve(&(exact - &values * &weights), 1e-12).ok()?;
        rule.weights.iter_mut().zip(roots.component_mul(&change).iter()).for_each(|(weight, change)| *weight += change);
        if rule.weights.iter().any(|weight| *weight <= 0.0) {
            return None;
        }
    }
    ((means(&rule, degree) - exact).amax() < EXACT).then_some(rule)
}

/// The invariant polynomials (rows) at the points.
fn values(rule: &Quadrature, degree: usize) -> DMatrix<f64> {
    let powers: Vec<(i32, i32)> = (0..=degree / 4).flat_map(|i| (0..=(degree - 4 * i) / 6).map(move |j| (i as i32, j as i32))).collect();
    let invariants: Vec<(f64, f64)> = rule.directions.chunks(3).map(invariants).collect();
    DMatrix::from_fn(powers.len(), invariants.len(), |row, point| {
        invariants[point].0.powi(powers[row].0) * invariants[point].1.powi(powers[row].1)
    })
}

/// The two invariants, over their range: between -1 and 1, and between 0 and 1.
fn invariants(point: &[f64]) -> (f64, f64) {
    let fourth: f64 = point.iter().map(|x| x.powi(4)).sum();
    let product: f64 = point.iter().product();
    (3.0 * fourth - 2.0, 27.0 * product * product)
}

fn means(rule: &Quadrature, degree: usize) -> DVector<f64> {
    values(rule, degree) * DVector::from_column_slice(&rule.weights)
}
