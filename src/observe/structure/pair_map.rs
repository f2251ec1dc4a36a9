//! The pair distribution by direction in the plane of a shear: `g(r, theta)`.
//!
//! In three dimensions pairs count that point out of the plane by less than a quarter of their separation. The ideal gas is that of the same directions, so neither
//! walls nor the thickness of this part of the sphere make the map differ from 1.

use std::f64::consts::PI;

use nalgebra::SVector;
use serde::Serialize;

use super::ideal_gas::Ideal;
use crate::{geometry::Domain, observe::Shear};

/// Width of a ring in sums of radii, and the farthest one.
const WIDTH: f64 = 0.05;
const FARTHEST: f64 = 2.5;

/// Sectors of half a turn.
const SECTORS: usize = 18;

/// Part of the separation that may point out of the plane.
const OUT_OF_PLANE: f64 = 0.25;

/// Points of the quadrature over the directions of a sector, in the plane and across it.
const POINTS: usize = 16;

/// Counts of pairs by ring and sector.
pub(super) struct PlaneCounts<const D: usize> {
    /// Directions of the flow and of the gradient, x and y without a shear.
    plane: [SVector<f64, D>; 2],
    rings: Vec<[usize; SECTORS]>,
}

/// The pair distribution over separation and direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairMap {
    /// Middles of rings of the separation over the sum of the radii.
    pub separations: Vec<f64>,
    /// Middles of sectors in degrees from the direction of the flow towards that of the gradient (from x to y without a shear), over half a turn.
    pub degrees: Vec<f64>,
    /// Of each ring and sector the density of pairs over that of an ideal gas in the same box.
    pub distribution: Vec<Vec<f64>>,
}

impl<const D: usize> PlaneCounts<D> {
    /// No pair yet, in a shear or without, up to a gap in sums of radii.
    pub(super) fn new(shear: Option<&Shear<D>>, farthest: f64) -> Self {
        let unit = |axis: usize| SVector::from_fn(|other, _| if other == axis { 1.0 } else { 0.0 });
        let plane = shear.map_or([unit(0), unit(1)], |shear| [shear.flow, shear.across()]);
        let rings = (farthest.min(FARTHEST - 1.0) / WIDTH + 1e-9) as usize;
        PlaneCounts { plane, rings: vec![[0; SECTORS]; rings] }
    }

    /// Counts a pair of this separation and gap, which is in sums of radii.
    pub(super) fn count(&mut self, separation: &SVector<f64, D>, gap: f64) {
        let [flow, gradient] = self.plane.map(|direction| separation.dot(&direction));
        let across = separation.norm_squared() - flow * flow - gradient * gradient;
        if D == 3 && across > OUT_OF_PLANE * OUT_OF_PLANE * separation.norm_squared() {
            return;
        }
        let turn = gradient.atan2(flow).rem_euclid(PI) / PI;
        if let Some(ring) = self.rings.get_mut((gap / WIDTH) as usize) {
            ring[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] += 1;
        }
    }

    /// All counts.
    pub(super) fn all(&mut self) -> impl Iterator<Item = &mut usize> {
        self.rings.iter_mut().flatten()
    }

    /// The map over configurations of bodies with these radii in a box.
    pub(super) fn distribution(&self, domain: &Domain<D>, radii: &[f64], configurations: usize) -> PairMap {
        let ideal: Vec<Ideal<D>> = (0..SECTORS).map(|sector| Ideal::in_directions(domain, radii, &self.directions(sector))).collect();
        let edge = |ring: usize| 1.0 + WIDTH * ring as f64;
        let density = |ring: usize, sector: usize| {
            self.rings[ring][sector] as f64 / (configurations as f64 * ideal[sector].pairs(edge(ring), edge(ring + 1)))
        };
        let rings = || 0..self.rings.len();
        PairMap {
            separations: rings().map(|ring| 0.5 * (edge(ring) + edge(ring + 1))).collect(),
            degrees: (0..SECTORS).map(|sector| 180.0 * (sector as f64 + 0.5) / SECTORS as f64).collect(),
            distribution: rings().map(|ring| (0..SECTORS).map(|sector| density(ring, sector)).collect()).collect(),
        }
    }

    /// Directions of a sector and of the opposite one, by which a pair is counted alike, and their weights.
    fn directions(&self, sector: usize) -> Vec<(SVector<f64, D>, f64)> {
        let angle = PI / SECTORS as f64;
        let middle = |point: usize| (point as f64 + 0.5) / POINTS as f64;
        let (layers, thickness) = if D == 3 { (POINTS, 2.0 * OUT_OF_PLANE) } else { (1, 1.0) };
        let weight = 2.0 * angle / POINTS as f64 * thickness / layers as f64;
        let layer = |layer: usize| if D == 3 { OUT_OF_PLANE * (2.0 * middle(layer) - 1.0) } else { 0.0 };
        let across = self.across();
        let all = (0..POINTS).flat_map(|point| (0..layers).map(move |layer| (point, layer)));
        let direction = |(point, number): (usize, usize)| {
            let (turn, out) = (angle * (sector as f64 + middle(point)), layer(number));
            let inside = self.plane[0] * turn.cos() + self.plane[1] * turn.sin();
            (inside * (1.0 - out * out).sqrt() + across * out, weight)
        };
        all.map(direction).collect()
    }

    /// The direction across the plane in three dimensions; zero in two.
    fn across(&self) -> SVector<f64, D> {
        let rest = |axis: usize| {
            let unit = SVector::<f64, D>::from_fn(|other, _| if other == axis { 1.0 } else { 0.0 });
            unit - self.plane[0] * self.plane[0][axis] - self.plane[1] * self.plane[1][axis]
        };
        let longest = (0..D).map(rest).max_by(|one, other| one.norm().total_cmp(&other.norm()));
        longest.and_then(|longest| longest.try_normalize(1e-6)).unwrap_or_else(SVector::zeros)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{
        geometry::{Axis, Ball, LeesEdwards},
        observe::{PairCounts, PairDistribution},
    };

    fn along<const D: usize>(flow: usize, gradient: usize) -> Shear<D> {
        let flow = SVector::from_fn(|axis, _| if axis == flow { 1.0 } else { 0.0 });
        Shear { flow, gradient, rate: 1.0, at_rest: false }
    }

    fn of_a_gas<const D: usize>(size: [f64; D], walled: usize, shear: Option<Shear<D>>) -> PairDistribution {
        let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let axes = std::array::from_fn(|axis| if axis == walled { wall } else { Axis::Periodic });
        let (domain, mut random) = (Domain { size: SVector::from(size), axes }, ChaCha8Rng::seed_from_u64(3));
        let mut counts = PairCounts::new(&domain, &[0.5; 80], shear);
        for _ in 0..300 {
            let mut place = |axis: usize| {
                let margin = if axis == walled { 0.5 } else { 0.0 };
                margin + random.random::<f64>() * (size[axis] - 2.0 * margin)
            };
            let mut ball = |_| Ball { center: SVector::from_fn(|axis, _| place(axis)), radius: 0.5 };
            counts.add(&domain, &(0..80).map(&mut ball).collect::<Vec<_>>());
        }
        counts.distribution().expect("there are pairs")
    }

    /// Points at random: 1 in every direction, between walls too, whichever axes flow and gradient are.
    #[test]
    fn the_map_of_an_ideal_gas_is_flat() {
        let flat = |found: PairDistribution, scatter: f64| {
            for sector in 0..SECTORS {
                // the first ring holds overlaps
                let rings: Vec<f64> = found.map.distribution[1..].iter().map(|ring| ring[sector]).collect();
                let mean = rings.iter().sum::<f64>() / rings.len() as f64;
                assert!((mean - 1.0).abs() < scatter, "{mean} in sector {sector}");
            }
        };
        for walled in [2, 1, 0] {
            flat(of_a_gas([12.0, 9.0], walled, None), 0.06);
            flat(of_a_gas([12.0, 9.0], walled, Some(along(1, 0))), 0.06);
        }
        for (flow, gradient) in [(0, 1), (2, 0), (1, 2)] {
            flat(of_a_gas([7.0, 6.0, 8.0], gradient, Some(along(flow, gradient))), 0.12);
        }
    }

    /// What the map has of each ring, weighted by the ideal gas, is what the radial distribution has of it.
    #[test]
    fn no_pair_of_the_plane_is_lost() {
        let found = of_a_gas([12.0, 9.0], 2, None);
        for (ring, sectors) in found.map.distribution.iter().enumerate() {
            let [inner, outer] = [2 * ring, 2 * ring + 1].map(|bin| found.radial[bin]);
            let expected = (inner.0 * inner.1 + outer.0 * outer.1) / (inner.0 + outer.0);
            assert!((sectors.iter().sum::<f64>() / SECTORS as f64 - expected).abs() < 1e-12);
        }
    }

    /// One pair across the seam: it is found where the images are that have slid, and nowhere else.
    #[test]
    fn a_pair_is_where_its_images_have_slid_to() {
        let domain = |time: f64| Domain {
            size: Vector2::new(16.0, 8.0),
            axes: [Axis::Periodic, Axis::Sheared(LeesEdwards::steady(0.0, 8.0, time))],
        };
        let balls = [[1.0, 7.5], [1.0, 0.2]].map(|center| Ball { center: Vector2::from(center), radius: 0.4 });
        for (time, [x, y]) in [(0.15, [1.2_f64, 0.7_f64]), (1.85, [-1.2, 0.7]), (2.15, [1.2, 0.7])] {
            let start = domain(0.0);
            let mut counts = PairCounts::new(&start, &[0.4; 2], Some(along(0, 1)));
            counts.add(&domain(time), &balls);
            let map = counts.distribution().expect("there is a pair").map;
            let [ring, sector] = [(x.hypot(y) / 0.8 - 1.0) / WIDTH, y.atan2(x) / PI * SECTORS as f64].map(|place| place as usize);
            for (at, sectors) in map.distribution.iter().enumerate() {
                assert!(
                    sectors.iter().enumerate().all(|(along, value)| (*value > 0.0) == ((at, along) == (ring, sector))),
                    "{time}: {map:?}"
                );
            }
        }
    }

    /// In three dimensions pairs along the vorticity are left out.
    #[test]
    fn pairs_out_of_the_plane_do_not_count() {
        let mut counts = PlaneCounts::<3>::new(Some(&along(2, 0)), 1.5);
        for (separation, counted) in [([1.0, 0.2, 0.5], true), ([0.0, 1.0, 0.0], false), ([0.5, 0.5, 0.5], false), ([0.0, 0.0, 1.0], true)]
        {
            let before: usize = counts.all().map(|count| *count).sum();
            counts.count(&SVector::from(separation), 0.1);
            assert_eq!(counts.all().map(|count| *count).sum::<usize>() - before, usize::from(counted), "{separation:?}");
        }
    }
}
