//! Modes and quadrature by the dimension: circles in 2D, spheres in 3D.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use super::{
    circle_pair,
    fourier::{self, Fourier},
    modes::Modes,
    quadrature::{Quadrature, circle, octahedral},
    sphere_pair,
    spherical::{self, Spherical},
};
use crate::linalg::ROUNDING;

/// Highest order of modes that are tabulated.
pub fn highest_order(dimension: usize) -> usize {
    if dimension == 2 { fourier::MAXIMUM_ORDER } else { spherical::MAXIMUM_ORDER }
}

/// Number of modes of a family up to `order`, rigid ones included.
pub fn mode_count(dimension: usize, order: usize) -> usize {
    match dimension {
        2 => 4 * order + 1,
        _ => 3 * order * (order + 2),
    }
}

/// The modes of a ball in a fluid of unit viscosity: Fourier modes `|k| <= order` on a circle, vector spherical harmonics `l <= order` on a sphere.
///
/// # Panics
///
/// If `dimension` is not 2 or 3, or `order` is not between 1 and the `MAXIMUM_ORDER` of the family.
pub fn modes(dimension: usize, radius: f64, order: usize) -> Box<dyn Modes> {
    match dimension {
        2 => Box::new(Fourier::new(radius, order)),
        3 => Box::new(Spherical::new(radius, order)),
        _ => panic!("modes exist in dimension 2 and 3, not {dimension}"),
    }
}

/// The velocity that modes of the second of two balls cause on the first in unbounded fluid of unit viscosity, in the frames of the pair, in each of
/// which the other ball is at a `distance` along the axis (the first in 2D, the third in 3D): they differ by half a turn about the second axis
/// (2D: the centre).
///
/// Entry `(i, j)` is the mean over the first ball of `F_m . u_n` for the modes `m = rows[i]` and `n = columns[j]`, all of which have
/// one number among the [`orders`](super::Degree::orders); others do not feel each other. `reach` as in
/// [`isolated_mobility`](Modes::isolated_mobility).
pub fn pair_mobility(dimension: usize, radii: [f64; 2], distance: f64, reach: f64, members: [&[usize]; 2]) -> DMatrix<f64> {
    match dimension {
        2 => circle_pair::pair_mobility(radii, distance, reach, members),
        _ => sphere_pair::pair_mobility(radii, distance, members),
    }
}

/// The velocity that a plane wall at `height` above the centre of a ball, along the axis, sends back from its modes, as [`pair_mobility`] has it; of 3D
/// those modes that are even in the second coordinate.
pub fn wall_mobility(dimension: usize, radius: f64, height: f64, reach: f64, members: &[usize]) -> DMatrix<f64> {
    match dimension {
        2 => circle_pair::wall_mobility(radius, height, reach, members),
        _ => sphere_pair::wall_mobility(radius, height, members),
    }
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
        3 => octahedral::rule((order + 3 + (radius_over_spacing * (1.0 - ROUNDING)).ceil() as usize).div_ceil(2), 2 * (order + 1)),
        _ => panic!("quadrature exists in dimension 2 and 3, not {dimension}"),
    }
}
