//! How bodies lie to each other: pair distribution, its dependence on direction at contact, coordination number.
//!
//! Pairs are counted by their separation over the sum of the radii, each periodic image for itself, and compared with those of an ideal gas
//! of points in the same box: uniform where centres can be, which is up to a mean radius from walls. A pair of such points is `r n` apart
//! with density `prod over walled axes (1 - r |n_k| / L_k) / (prod of all lengths)`, with `L_k` the length that centres can reach, so walls
//! alone do not make the distribution differ from 1. Where images slide, each configuration has those of its own time. Pairs of a body and a wall, or of a body and its own image, are not counted.

use std::f64::consts::PI;

use serde::Serialize;

use super::Shear;
use crate::{
    geometry::{Ball, Domain, Pair, visit_near_pairs},
    parallel::World,
};

/// Gap in mean radii of the pair up to which two bodies are neighbours.
pub const NEAR: f64 = 0.1;

/// Width of a bin in sums of radii, and the farthest separation.
const WIDTH: f64 = 0.025;
const FARTHEST: f64 = 4.0;

/// Bins of the direction between neighbours over half a turn.
const DIRECTIONS: usize = 18;

/// Counts of pairs over configurations of the same bodies.
pub struct PairCounts<'a, const D: usize> {
    domain: &'a Domain<D>,
    radii: &'a [f64],
    shear: Option<Shear<D>>,
    radial: Vec<usize>,
    directions: Vec<usize>,
    neighbours: usize,
    configurations: usize,
}

/// Means over configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairDistribution {
    /// Configurations that were averaged.
    pub configurations: usize,
    /// Mean number of neighbours of a body: others with a gap below [`NEAR`] mean radii of the two.
    pub coordination: f64,
    /// Middles of bins of the separation over the sum of the radii, and the density of pairs over that of an ideal gas in the same box.
    pub radial: Vec<(f64, f64)>,
    /// Middles of bins of the direction between neighbours, in degrees from the direction of the flow towards that of the gradient (from x
    /// to y without a shear), and their number over the mean of all bins; in three dimensions of the projection on that plane.
    pub angular: Vec<(f64, f64)>,
}

impl<'a, const D: usize> PairCounts<'a, D> {
    /// No configuration yet of bodies with these radii in a box at any time, with the shear that directions refer to.
    pub fn new(domain: &'a Domain<D>, radii: &'a [f64], shear: Option<Shear<D>>) -> Self {
        let bins = ((farthest(domain, radii) - 1.0) / WIDTH + 1e-9).max(0.0) as usize;
        let (radial, directions) = (vec![0; bins], vec![0; DIRECTIONS]);
        PairCounts { domain, radii, shear, radial, directions, neighbours: 0, configurations: 0 }
    }

    /// Adds a configuration in the box as it is at its time, to which images have slid if they do; bodies in the order of the radii.
    pub fn add(&mut self, domain: &Domain<D>, balls: &[Ball<D>]) {
        let largest = self.radii.iter().copied().fold(0.0, f64::max);
        let far = WIDTH * self.radial.len() as f64;
        let reach = 2.0 * largest * far.max(0.5 * NEAR);
        visit_near_pairs(domain, balls, reach, |pair| self.count(&pair));
        self.configurations += 1;
    }

    fn count(&mut self, pair: &Pair<D>) {
        if pair.first == pair.second {
            return;
        }
        let sum = self.radii[pair.first] + self.radii[pair.second];
        if let Some(count) = self.radial.get_mut((pair.gap.max(0.0) / sum / WIDTH) as usize) {
            *count += 1;
        }
        if pair.gap < 0.5 * NEAR * sum {
            self.neighbours += 1;
            let direction = self.direction(pair);
            self.directions[direction] += 1;
        }
    }

    /// Adds up the configurations of all ranks. Collective.
    pub fn sum(&mut self, world: &World) {
        let single = [&mut self.neighbours, &mut self.configurations];
        let counts: Vec<&mut usize> = self.radial.iter_mut().chain(&mut self.directions).chain(single).collect();
        // whole numbers, of which floating-point ones lose nothing
        let mut sums: Vec<f64> = counts.iter().map(|count| **count as f64).collect();
        world.sum(&mut sums);
        counts.into_iter().zip(sums).for_each(|(count, sum)| *count = sum as usize);
    }

    /// The means; nothing without a configuration or a pair of bodies.
    pub fn distribution(&self) -> Option<PairDistribution> {
        if self.configurations == 0 || self.radii.len() < 2 {
            return None;
        }
        let ideal = Ideal::new(self.domain, self.radii);
        let density = |(bin, &count): (usize, &usize)| {
            let (from, to) = (1.0 + WIDTH * bin as f64, 1.0 + WIDTH * (bin + 1) as f64);
            (0.5 * (from + to), count as f64 / (self.configurations as f64 * ideal.pairs(from, to)))
        };
        let mean = self.neighbours as f64 / DIRECTIONS as f64;
        let part = |(bin, &count): (usize, &usize)| {
            let degrees = 180.0 * (bin as f64 + 0.5) / DIRECTIONS as f64;
            (degrees, if mean > 0.0 { count as f64 / mean } else { 0.0 })
        };
        Some(PairDistribution {
            configurations: self.configurations,
            coordination: 2.0 * self.neighbours as f64 / (self.configurations * self.radii.len()) as f64,
            radial: self.radial.iter().enumerate().map(density).collect(),
            angular: self.directions.iter().enumerate().map(part).collect(),
        })
    }

    /// The bin of the direction of a pair, which has no sense.
    fn direction(&self, pair: &Pair<D>) -> usize {
        let (flow, gradient) = match &self.shear {
            Some(shear) => (pair.separation.dot(&shear.flow), pair.separation[shear.gradient]),
            None => (pair.separation[0], pair.separation[1]),
        };
        let turn = gradient.atan2(flow).rem_euclid(PI) / PI;
        ((turn * DIRECTIONS as f64) as usize).min(DIRECTIONS - 1)
    }
}

/// The farthest separation in sums of radii: half a period, and the room between walls, is the limit.
fn farthest<const D: usize>(domain: &Domain<D>, radii: &[f64]) -> f64 {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let room = (0..D).map(|axis| if domain.periodic(axis) { 0.5 * domain.size[axis] } else { reachable(domain, radii, axis) });
    (room.fold(f64::INFINITY, f64::min) / (2.0 * largest)).min(FARTHEST)
}

/// The length along an axis that centres can reach.
fn reachable<const D: usize>(domain: &Domain<D>, radii: &[f64], axis: usize) -> f64 {
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    if domain.periodic(axis) { domain.size[axis] } else { domain.size[axis] - 2.0 * mean }
}

/// Pairs of an ideal gas: `sum over m of factors[m] sums[m] int s^(D - 1 + m) ds`.
struct Ideal<const D: usize> {
    /// For `m` walled axes: solid angle times mean of `prod -|n_k| / L_k`, over the room of centres.
    factors: Vec<f64>,
    /// For `m` walled axes: sum over all pairs of the power `D + m` of their sums of radii.
    sums: Vec<f64>,
}

impl<const D: usize> Ideal<D> {
    fn new(domain: &Domain<D>, radii: &[f64]) -> Self {
        let room: f64 = (0..D).map(|axis| reachable(domain, radii, axis)).product();
        let walled: Vec<f64> = (0..D).filter(|&axis| !domain.periodic(axis)).map(|axis| -1.0 / reachable(domain, radii, axis)).collect();
        let mut products = vec![0.0; D + 1];
        for subset in 0..1_u32 << walled.len() {
            let chosen = walled.iter().enumerate().filter(|(axis, _)| subset >> axis & 1 == 1);
            products[subset.count_ones() as usize] += chosen.map(|(_, factor)| factor).product::<f64>();
        }
        let factors = products.iter().enumerate().map(|(axes, product)| directions::<D>(axes) * product / room).collect();
        Ideal { factors, sums: sums_of_powers::<D>(radii) }
    }

    /// Expected pairs between two separations in sums of radii.
    fn pairs(&self, from: f64, to: f64) -> f64 {
        let term = |(axes, (factor, sum)): (usize, (&f64, &f64))| {
            let power = (D + axes) as i32;
            factor * sum * (to.powi(power) - from.powi(power)) / f64::from(power)
        };
        self.factors.iter().zip(&self.sums).enumerate().map(term).sum()
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
    use nalgebra::{SVector, Vector2};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::geometry::{Axis, LeesEdwards};

    fn domain<const D: usize>(size: [f64; D], walled: [bool; D]) -> Domain<D> {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        Domain { size: SVector::from(size), axes: walled.map(|walled| if walled { wall } else { Axis::Periodic }) }
    }

    /// Points anywhere, overlaps and all, are an ideal gas: the distribution is 1 between any walls and for any radii.
    fn of_an_ideal_gas<const D: usize>(size: [f64; D], walled: [bool; D], radii: &[f64]) -> PairDistribution {
        let domain = domain(size, walled);
        let mut counts = PairCounts::new(&domain, radii, None);
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        for _ in 0..400 {
            let mut place = |axis: usize| {
                let margin = if walled[axis] { mean } else { 0.0 };
                margin + random.random::<f64>() * (size[axis] - 2.0 * margin)
            };
            let mut ball = |&radius: &f64| Ball { center: SVector::from_fn(|axis, _| place(axis)), radius };
            counts.add(&domain, &radii.iter().map(&mut ball).collect::<Vec<_>>());
        }
        counts.distribution().expect("there are pairs")
    }

    fn assert_ideal(distribution: &PairDistribution, scatter: f64) {
        // the first bin holds overlaps as well
        for (separation, density) in &distribution.radial[1..] {
            assert!((density - 1.0).abs() < scatter, "{density} at {separation}");
        }
        let count = distribution.radial.len() - 1;
        let mean = distribution.radial[1..].iter().map(|(_, density)| density).sum::<f64>() / count as f64;
        // four times what such means scatter between walls
        assert!((mean - 1.0).abs() < 1.2e-2, "{mean} over {count} bins");
    }

    #[test]
    fn an_ideal_gas_has_the_distribution_1_between_any_walls() {
        let radii = [0.5; 60];
        for walled in [[false, false], [false, true], [true, true]] {
            assert_ideal(&of_an_ideal_gas([12.0, 9.0], walled, &radii), 0.12);
        }
        for walled in [[false, false, false], [false, true, false], [false, true, true], [true, true, true]] {
            assert_ideal(&of_an_ideal_gas([7.0, 6.0, 8.0], walled, &radii), 0.2);
        }
    }

    #[test]
    fn sums_over_pairs_are_those_of_all_pairs_one_by_one() {
        let radii = [0.3, 0.7, 0.7, 1.1, 0.5];
        let pairs = || (0..radii.len()).flat_map(|one| (0..one).map(move |two| radii[one] + radii[two]));
        for (axes, sum) in sums_of_powers::<3>(&radii).into_iter().enumerate() {
            let expected: f64 = pairs().map(|sum| sum.powi(3 + axes as i32)).sum();
            assert!((sum / expected - 1.0).abs() < 1e-14, "{sum} instead of {expected}");
        }
    }

    #[test]
    fn radii_may_differ() {
        let radii: Vec<f64> = (0..60).map(|body| if body % 3 == 0 { 0.6 } else { 0.3 }).collect();
        assert_ideal(&of_an_ideal_gas([12.0, 9.0], [false, false], &radii), 0.15);
    }

    /// A disk at the top and one at the bottom, whose image above has slid aside: it is not where it would be in a box at rest.
    #[test]
    fn images_that_slide_are_counted_where_they_are_at_that_time() {
        let slide = LeesEdwards::steady(0.0, 8.0, 0.0);
        let domain = Domain { size: Vector2::new(16.0, 8.0), axes: [Axis::Periodic, Axis::Sheared(slide)] };
        let balls = [[1.0, 7.5], [1.0, 0.2]].map(|center| Ball { center: Vector2::from(center), radius: 1.0 });
        // separations of 0.7, of (2, 0.7), of (-1.8, 0.7) and, after whole lengths of the box, of 0.7 again
        for (time, separation) in [(0.0, 0.35), (0.25, 1.0595), (1.775, 0.9657), (4.0, 0.35)] {
            let mut counts = PairCounts::new(&domain, &[1.0; 2], None);
            counts.add(&domain.clone().at(time), &balls);
            let bin = ((f64::max(separation, 1.0) - 1.0) / WIDTH) as usize;
            let found: Vec<usize> = counts.radial.iter().enumerate().filter(|(_, count)| **count > 0).map(|(bin, _)| bin).collect();
            assert_eq!(found, [bin], "at {time}");
        }
    }

    /// Four disks of a square lattice whose gaps are 0.08 radii: each has four neighbours, along x and y, of which two are periodic images.
    #[test]
    fn neighbours_across_the_seam_count() {
        let domain = domain([4.16, 4.16], [false, false]);
        let radii = [1.0; 4];
        let balls: Vec<Ball<2>> =
            [[1.0, 1.0], [3.08, 1.0], [1.0, 3.08], [3.08, 3.08]].map(|center| Ball { center: Vector2::from(center), radius: 1.0 }).to_vec();
        let mut counts = PairCounts::new(&domain, &radii, None);
        counts.add(&domain, &balls);
        let distribution = counts.distribution().expect("there are pairs");
        assert_eq!((distribution.configurations, distribution.coordination), (1, 4.0));
        let directions: Vec<f64> = distribution.angular.iter().filter(|(_, part)| *part > 0.0).map(|(degrees, _)| *degrees).collect();
        assert!(directions.iter().all(|degrees| [5.0, 85.0, 95.0, 175.0].contains(degrees)), "{directions:?}");
        assert_eq!(PairCounts::new(&domain, &radii, None).distribution(), None);
    }
}
