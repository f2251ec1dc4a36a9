//! How bodies lie to each other: pair distribution, its dependence on direction at contact, coordination number.
//!
//! Pairs are counted by their separation over the sum of the radii, each periodic image for itself, and compared with those of an ideal gas
//! of points in the same box, so walls alone do not make the distribution differ from 1. Bodies of a few sizes have distributions of each two of these too, whose
//! mean, weighted by the pairs of the ideal gas, is that of all. Where images slide, each configuration has those of its own time. Pairs of a body and a wall, or of a body and its own image, are not counted.

use std::f64::consts::PI;

use serde::Serialize;

use super::{
    ideal_gas::{Ideal, reachable},
    pair_map::{PairMap, PlaneCounts},
};
use crate::{
    geometry::{Ball, Domain, Pair, visit_near_pairs},
    observe::{Shear, species, species_of},
    parallel::World,
};

/// Gap in mean radii of the pair up to which two bodies are neighbours.
pub const NEAR: f64 = 0.1;

/// Width of a bin in sums of radii, and the farthest separation.
const WIDTH: f64 = 0.025;
const FARTHEST: f64 = 4.0;

/// Bins of the direction between neighbours over half a turn.
const DIRECTIONS: usize = 18;

/// Most species whose pairs are told apart.
const MOST_SPECIES: usize = 3;

/// Counts of pairs over configurations of the same bodies.
pub struct PairCounts<'a, const D: usize> {
    domain: &'a Domain<D>,
    radii: &'a [f64],
    shear: Option<Shear<D>>,
    radial: Vec<usize>,
    species: Option<Species>,
    map: PlaneCounts<D>,
    directions: Vec<usize>,
    neighbours: usize,
    configurations: usize,
}

/// Pairs of bodies of several sizes, told apart.
struct Species {
    /// Radius and number of bodies of each, from the smallest on.
    sizes: Vec<(f64, usize)>,
    /// Of each body.
    of: Vec<usize>,
    /// Of each two species, the first one not the larger, the counts of bins of the separation.
    counts: Vec<([usize; 2], Vec<usize>)>,
}

/// The pair distribution of bodies of two sizes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartialDistribution {
    /// Their radii, the smaller one first.
    pub radii: [f64; 2],
    /// Middles of bins of the separation over the sum of the radii, and the density of such pairs over that of an ideal gas.
    pub radial: Vec<(f64, f64)>,
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
    /// The same of each two sizes, where bodies have two or three.
    pub partial: Vec<PartialDistribution>,
    /// The same by direction in the plane of the shear.
    pub map: PairMap,
    /// Middles of bins of the direction between neighbours, in degrees from the direction of the flow towards that of the gradient (from x
    /// to y without a shear), and their number over the mean of all bins; in three dimensions of the projection on that plane.
    pub angular: Vec<(f64, f64)>,
}

impl<'a, const D: usize> PairCounts<'a, D> {
    /// No configuration yet of bodies with these radii in a box at any time, with the shear that directions refer to.
    pub fn new(domain: &'a Domain<D>, radii: &'a [f64], shear: Option<Shear<D>>) -> Self {
        let bins = ((farthest(domain, radii) - 1.0) / WIDTH + 1e-9).max(0.0) as usize;
        let (radial, directions) = (vec![0; bins], vec![0; DIRECTIONS]);
        let (species, map) = (Species::new(radii, bins), PlaneCounts::new(shear.as_ref(), WIDTH * bins as f64));
        PairCounts { domain, radii, shear, radial, species, map, directions, neighbours: 0, configurations: 0 }
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
        let bin = (pair.gap.max(0.0) / sum / WIDTH) as usize;
        if let Some(count) = self.radial.get_mut(bin) {
            *count += 1;
            self.species.iter_mut().for_each(|species| species.count([pair.first, pair.second], bin));
        }
        self.map.count(&pair.separation, pair.gap.max(0.0) / sum);
        if pair.gap < 0.5 * NEAR * sum {
            self.neighbours += 1;
            let direction = self.direction(pair);
            self.directions[direction] += 1;
        }
    }

    /// Adds up the configurations of all ranks. Collective.
    pub fn sum(&mut self, world: &World) {
        let single = [&mut self.neighbours, &mut self.configurations];
        let of_species = self.species.iter_mut().flat_map(|species| &mut species.counts).flat_map(|(_, counts)| counts);
        let counts: Vec<&mut usize> =
            self.radial.iter_mut().chain(&mut self.directions).chain(single).chain(of_species).chain(self.map.all()).collect();
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
        let mean = self.neighbours as f64 / DIRECTIONS as f64;
        let part = |(bin, &count): (usize, &usize)| {
            let degrees = 180.0 * (bin as f64 + 0.5) / DIRECTIONS as f64;
            (degrees, if mean > 0.0 { count as f64 / mean } else { 0.0 })
        };
        Some(PairDistribution {
            configurations: self.configurations,
            coordination: 2.0 * self.neighbours as f64 / (self.configurations * self.radii.len()) as f64,
            radial: self.densities(&Ideal::new(self.domain, self.radii), &self.radial),
            partial: self.partial(),
            map: self.map.distribution(self.domain, self.radii, self.configurations),
            angular: self.directions.iter().enumerate().map(part).collect(),
        })
    }

    /// Middles of bins, and counts over the pairs of an ideal gas.
    fn densities(&self, ideal: &Ideal<D>, counts: &[usize]) -> Vec<(f64, f64)> {
        let density = |(bin, &count): (usize, &usize)| {
            let (from, to) = (1.0 + WIDTH * bin as f64, 1.0 + WIDTH * (bin + 1) as f64);
            (0.5 * (from + to), count as f64 / (self.configurations as f64 * ideal.pairs(from, to)))
        };
        counts.iter().enumerate().map(density).collect()
    }

    fn partial(&self) -> Vec<PartialDistribution> {
        let of_species = |species: &Species| {
            let of_two = |(two, counts): &([usize; 2], Vec<usize>)| {
                let (radii, pairs) = (two.map(|one| species.sizes[one].0), species.pairs(*two));
                let ideal = Ideal::new(self.domain, self.radii).of_pairs(pairs, radii[0] + radii[1]);
                // a single body of a size makes no pair with its like
                (pairs > 0.0).then(|| PartialDistribution { radii, radial: self.densities(&ideal, counts) })
            };
            species.counts.iter().filter_map(of_two).collect()
        };
        self.species.as_ref().map_or(Vec::new(), of_species)
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

impl Species {
    /// Those of bodies with these radii; nothing where all are alike, or few are.
    fn new(radii: &[f64], bins: usize) -> Option<Species> {
        let of: Vec<usize> = species_of(radii).into_iter().flatten().collect();
        let sizes: Vec<(f64, usize)> = species(radii)
            .into_iter()
            .enumerate()
            .map(|(number, radius)| (radius, of.iter().filter(|own| **own == number).count()))
            .collect();
        let two = (0..sizes.len()).flat_map(|one| (one..sizes.len()).map(move |other| [one, other]));
        let counts = two.map(|two| (two, vec![0; bins])).collect();
        (2..=MOST_SPECIES).contains(&sizes.len()).then_some(Species { sizes, of, counts })
    }

    fn count(&mut self, bodies: [usize; 2], bin: usize) {
        let mut own = bodies.map(|body| self.of[body]);
        own.sort_unstable();
        self.counts.iter_mut().filter(|(two, _)| *two == own).for_each(|(_, counts)| counts[bin] += 1);
    }

    /// How many pairs two species have.
    fn pairs(&self, [one, other]: [usize; 2]) -> f64 {
        let [first, second] = [one, other].map(|species| self.sizes[species].1 as f64);
        if one == other { 0.5 * first * (first - 1.0) } else { first * second }
    }
}

/// The farthest separation in sums of radii: half a period, and the room between walls, is the limit.
fn farthest<const D: usize>(domain: &Domain<D>, radii: &[f64]) -> f64 {
    let largest = radii.iter().copied().fold(0.0, f64::max);
    let room = (0..D).map(|axis| if domain.periodic(axis) { 0.5 * domain.size[axis] } else { reachable(domain, radii, axis) });
    (room.fold(f64::INFINITY, f64::min) / (2.0 * largest)).min(FARTHEST)
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

    /// Disks of two sizes at random, and those of one that shun their like: the counts of each two add up to those of all.
    #[test]
    fn pairs_of_each_two_sizes_are_told_apart() {
        let radii: Vec<f64> = (0..60).map(|body| if body % 3 == 0 { 0.6 } else { 0.3 }).collect();
        let found = of_an_ideal_gas([12.0, 9.0], [false, true], &radii);
        assert_eq!(found.partial.iter().map(|two| two.radii).collect::<Vec<_>>(), [[0.3, 0.3], [0.3, 0.6], [0.6, 0.6]]);
        for PartialDistribution { radial, .. } in &found.partial {
            let mean = radial[1..].iter().map(|(_, density)| density).sum::<f64>() / (radial.len() - 1) as f64;
            assert!((mean - 1.0).abs() < 0.04, "{mean}");
        }
        // weights of the ideal gas between two separations: of 780, 800 and 190 pairs
        let domain = domain([12.0, 9.0], [false, true]);
        for bin in 1..found.radial.len() {
            let [from, to] = [0, 1].map(|end| 1.0 + WIDTH * (bin + end) as f64);
            let weights = [(780.0, 0.6), (800.0, 0.9), (190.0, 1.2)]
                .map(|(count, sum)| Ideal::new(&domain, &radii).of_pairs(count, sum).pairs(from, to));
            let sum: f64 = found.partial.iter().zip(weights).map(|(two, weight)| weight * two.radial[bin].1).sum();
            assert!((sum / weights.iter().sum::<f64>() - found.radial[bin].1).abs() < 1e-12);
        }
        assert!(of_an_ideal_gas([12.0, 9.0], [false, false], &[0.5; 60]).partial.is_empty());
        let of_many_sizes: Vec<f64> = (0..60).map(|body| 0.3 + 0.005 * f64::from(body)).collect();
        assert!(of_an_ideal_gas([12.0, 9.0], [false, false], &of_many_sizes).partial.is_empty());
    }
}
