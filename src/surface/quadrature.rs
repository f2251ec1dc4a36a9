//! Quadrature on the unit circle and the unit sphere: means over the surface of a ball.

mod octahedral;

use std::f64::consts::PI;

use crate::linalg::gauss_legendre;

/// Points and weights of a mean over the surface of a ball.
#[derive(Clone, Debug)]
pub struct Quadrature {
    /// Outward unit normals of the points, `dimension` numbers each.
    pub directions: Vec<f64>,
    /// One weight per point; they sum to 1.
    pub weights: Vec<f64>,
}

/// The rule for modes of the given order on a ball of `radius_over_spacing = a/h`.
///
/// 2D: `max(ceil(2 pi a/h), 4 K + 4)` equispaced points. 3D: the points of an equiangular cube, at least
/// `(L + 3 + ceil(a/h))/2` a side. Both are exact for products of two modes; in
/// 2D points are at most `h` apart, in 3D up to about `pi h`.
///
/// # Panics
///
/// If `dimension` is not 2 or 3.
pub fn quadrature(dimension: usize, radius_over_spacing: f64, order: usize) -> Quadrature {
    match dimension {
        2 => circle(((2.0 * PI * radius_over_spacing).ceil() as usize).max(4 * order + 4)),
        3 => octahedral::rule((order + 3 + radius_over_spacing.ceil() as usize).div_ceil(2), 2 * (order + 1)),
        _ => panic!("quadrature exists in dimension 2 and 3, not {dimension}"),
    }
}

/// A rule for products of two modes that vary no faster than once round the axis of the pair's frame (the first in 2D, the third in 3D):
/// `count` equispaced points in 2D, as many Gauss-Legendre latitudes times four longitudes in 3D.
///
/// # Panics
///
/// If `dimension` is not 2 or 3.
pub fn axial(dimension: usize, count: usize) -> Quadrature {
    match dimension {
        2 => circle(count),
        3 => sphere(count, 4),
        _ => panic!("quadrature exists in dimension 2 and 3, not {dimension}"),
    }
}

fn circle(count: usize) -> Quadrature {
    Quadrature {
        directions: angles(count).flat_map(|angle| [angle.cos(), angle.sin()]).collect(),
        weights: vec![1.0 / count as f64; count],
    }
}

fn sphere(latitudes: usize, longitudes: usize) -> Quadrature {
    let mut rule = Quadrature { directions: Vec::new(), weights: Vec::new() };
    for (height, weight) in gauss_legendre(latitudes) {
        let distance = (1.0 - height * height).sqrt();
        for angle in angles(longitudes) {
            rule.directions.extend([distance * angle.cos(), distance * angle.sin(), height]);
            rule.weights.push(0.5 * weight / longitudes as f64);
        }
    }
    rule
}

fn angles(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |point| 2.0 * PI * point as f64 / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(rule: &Quadrature, dimension: usize, f: impl Fn(&[f64]) -> f64) -> f64 {
        let points = rule.directions.chunks(dimension);
        points.zip(&rule.weights).map(|(direction, weight)| weight * f(direction)).sum()
    }

    #[test]
    fn point_counts_follow_the_grid_or_the_modes() {
        assert_eq!(quadrature(2, 6.0, 4).weights.len(), 38);
        assert_eq!(quadrature(2, 2.0, 4).weights.len(), 20);
        assert_eq!(quadrature(3, 3.5, 3).weights.len(), 6 * 5 * 5);
    }

    /// Each reflection that takes axes to axes takes the rule on the sphere to itself.
    #[test]
    fn no_axis_is_told_from_another() {
        for (order, cells) in [(3, 5.0), (4, 6.0), (2, 3.0)] {
            let rule = quadrature(3, cells, order);
            let points: Vec<&[f64]> = rule.directions.chunks(3).collect();
            let weight_at = |wanted: &[f64]| {
                let same = |point: &&[f64]| point.iter().zip(wanted).all(|(one, other)| (one - other).abs() < 1e-14);
                points.iter().position(same).map(|found| rule.weights[found])
            };
            for (point, weight) in points.iter().zip(&rule.weights) {
                for axis in 0..3 {
                    let (mut swapped, mut mirrored) = (point.to_vec(), point.to_vec());
                    swapped.swap(axis, (axis + 1) % 3);
                    mirrored[axis] = -mirrored[axis];
                    for image in [swapped, mirrored] {
                        assert!(weight_at(&image).is_some_and(|found| (found - weight).abs() < 1e-15), "{point:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn points_lie_on_the_sphere_and_weights_sum_to_one() {
        for dimension in [2, 3] {
            let rule = quadrature(dimension, 4.2, 5);
            assert!((mean(&rule, dimension, |_| 1.0) - 1.0).abs() < 1e-14);
            for direction in rule.directions.chunks(dimension) {
                assert!((direction.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn the_circle_rule_is_exact_for_products_of_modes() {
        let (order, rule) = (5, quadrature(2, 0.1, 5));
        for wavenumber in 1..=2 * (order + 1) {
            let wave = |n: &[f64]| (wavenumber as f64 * n[1].atan2(n[0])).cos();
            assert!(mean(&rule, 2, wave).abs() < 1e-14);
        }
    }

    /// Exact: mean of `x^2i y^2j z^2k` is `(2i-1)!! (2j-1)!! (2k-1)!! / (2i+2j+2k+1)!!`.
    #[test]
    fn the_sphere_rule_is_exact_for_products_of_modes() {
        let odd = |n: i32| (1..=n).map(|k| f64::from(2 * k - 1)).product::<f64>();
        let (order, rule) = (4, quadrature(3, 0.1, 4));
        for i in 0..=order + 1 {
            for j in 0..=order + 1 - i {
                for k in 0..=order + 1 - i - j {
                    let exact = odd(i) * odd(j) * odd(k) / odd(i + j + k + 1);
                    let power = |n: &[f64]| n[0].powi(2 * i) * n[1].powi(2 * j) * n[2].powi(2 * k);
                    assert!((mean(&rule, 3, power) - exact).abs() < 1e-14);
                }
            }
        }
    }
}
