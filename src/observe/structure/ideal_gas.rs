//! How many pairs an ideal gas of points has in the box of a suspension: uniform where centres can be, which is up to a mean radius from walls.
//!
//! A pair of such points is `r n` apart with density `prod over walled axes (1 - r |n_k| / L_k) / (prod of all lengths)`, with `L_k` the length that centres can reach.

use std::f64::consts::PI;

use nalgebra::SVector;

use crate::geometry::Domain;

/// The length along an axis that centres can reach.
pub(super) fn reachable<const D: usize>(domain: &Domain<D>, radii: &[f64], axis: usize) -> f64 {
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    if domain.periodic(axis) { domain.size[axis] } else { domain.size[axis] - 2.0 * mean }
}

/// Pairs of an ideal gas, all of them or those of two species, in all directions or some: `sum over m of factors[m] sums[m] int s^(D - 1 + m) ds`.
pub(super) struct Ideal<const D: usize> {
    /// For `m` walled axes: solid angle times mean of `prod -|n_k| / L_k`, over the room of centres.
    factors: Vec<f64>,
    /// For `m` walled axes: sum over all pairs of the power `D + m` of their sums of radii.
    sums: Vec<f64>,
}

impl<const D: usize> Ideal<D> {
    /// Of all pairs of bodies with these radii in all directions.
    pub(super) fn new(domain: &Domain<D>, radii: &[f64]) -> Self {
        let room = Room::new(domain, radii);
        let products = room.symmetric(&[1.0; D]);
        let factors = products.iter().enumerate().map(|(axes, product)| directions::<D>(axes) * product / room.volume).collect();
        Ideal { factors, sums: sums_of_powers::<D>(radii) }
    }

    /// Of all pairs of bodies with these radii in directions that weigh so much each, of unit length.
    pub(super) fn in_directions(domain: &Domain<D>, radii: &[f64], directions: &[(SVector<f64, D>, f64)]) -> Self {
        let room = Room::new(domain, radii);
        let mut factors = vec![0.0; D + 1];
        for (direction, weight) in directions {
            let products = room.symmetric(&std::array::from_fn(|axis| direction[axis].abs()));
            factors.iter_mut().zip(products).for_each(|(factor, product)| *factor += weight * product / room.volume);
        }
        Ideal { factors, sums: sums_of_powers::<D>(radii) }
    }

    /// Of so many pairs of them alone, whose radii have this sum.
    pub(super) fn of_pairs(self, count: f64, sum_of_radii: f64) -> Self {
        Ideal { sums: (0..=D).map(|axes| count * sum_of_radii.powi((D + axes) as i32)).collect(), ..self }
    }

    /// Expected pairs between two separations in sums of radii.
    pub(super) fn pairs(&self, from: f64, to: f64) -> f64 {
        let term = |(axes, (factor, sum)): (usize, (&f64, &f64))| {
            let power = (D + axes) as i32;
            factor * sum * (to.powi(power) - from.powi(power)) / f64::from(power)
        };
        self.factors.iter().zip(&self.sums).enumerate().map(term).sum()
    }
}

/// The room of centres.
struct Room<const D: usize> {
    volume: f64,
    /// Along walled axes minus one over the length that centres can reach; 0 along others.
    walled: [f64; D],
}

impl<const D: usize> Room<D> {
    fn new(domain: &Domain<D>, radii: &[f64]) -> Room<D> {
        let length = |axis: usize| reachable(domain, radii, axis);
        Room {
            volume: (0..D).map(length).product(),
            walled: std::array::from_fn(|axis| if domain.periodic(axis) { 0.0 } else { -1.0 / length(axis) }),
        }
    }

    /// For `m` walled axes the sum over all choices of them of the product of their numbers times these ones.
    fn symmetric(&self, sizes: &[f64; D]) -> Vec<f64> {
        let mut sums = vec![0.0; D + 1];
        sums[0] = 1.0;
        for (walled, size) in self.walled.iter().zip(sizes) {
            (1..=D).rev().for_each(|axes| sums[axes] += walled * size * sums[axes - 1]);
        }
        sums
    }
}

/// Integral over all directions of the product of the sizes of so many components of the unit vector.
fn directions<const D: usize>(axes: usize) -> f64 {
    match (D, axes) {
        (2, 0) => 2.0 * PI,
        (2, 1) => 4.0,
        (2, 2) => 2.0,
        (_, 0) => 4.0 * PI,
        (_, 1) => 2.0 * PI,
        (_, 2) => 8.0 / 3.0,
        _ => 1.0,
    }
}

/// By the sums of powers of the radii: the binomial formula over all ordered pairs, less those of a body with itself.
fn sums_of_powers<const D: usize>(radii: &[f64]) -> Vec<f64> {
    let moments: Vec<f64> = (0..=2 * D as i32).map(|power| radii.iter().map(|radius| radius.powi(power)).sum()).collect();
    let sum = |power: usize| {
        let mut binomial = 1.0;
        let mut ordered = 0.0;
        for k in 0..=power {
            ordered += binomial * moments[k] * moments[power - k];
            binomial *= (power - k) as f64 / (k + 1) as f64;
        }
        0.5 * (ordered - 2_f64.powi(power as i32) * moments[power])
    };
    (0..=D).map(|axes| sum(D + axes)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_pairs_are_those_of_all_pairs_one_by_one() {
        let radii = [0.3, 0.7, 0.7, 1.1, 0.5];
        let pairs = || (0..radii.len()).flat_map(|one| (0..one).map(move |two| radii[one] + radii[two]));
        for (axes, sum) in sums_of_powers::<3>(&radii).into_iter().enumerate() {
            let expected: f64 = pairs().map(|sum| sum.powi(3 + axes as i32)).sum();
            assert!((sum / expected - 1.0).abs() < 1e-14, "{sum} instead of {expected}");
        }
    }
}
