//! The static structure factor: how far the places of bodies are from random at each length.
//!
//! ```text
//! S(k) = < |sum over bodies exp(i k.x)|^2 > / N
//! ```
//!
//! at the wave vectors `k` that fit the periodic box, of which those of nearly one length make a shell (Hansen and McDonald, Theory of Simple Liquids, section 4.1).
//! Where images slide by `shift` over the height `L_y`, they are those of the sheared lattice of the time,
//!
//! ```text
//! k_x = 2 pi m_x / L_x,   k_y = (2 pi m_y - k_x shift) / L_y,
//! ```
//!
//! and between walls those along the periodic axes alone. Bodies count alike, however large; of chains, cells and clusters each ball is one.

use std::f64::consts::TAU;

use nalgebra::SVector;

use super::wave_vectors::for_each_wave_vector;
use crate::{geometry::Domain, observe::statistics::interval, parallel::World};

/// The largest wave number times the mean radius.
const LARGEST: f64 = 10.0;
/// Shells are half as thick as the least wave number of the longest period, but thicker where they would be more than so many.
const THICKNESS: f64 = 0.5;
const MOST_SHELLS: f64 = 400.0;
/// Most wave vectors of a shell that are summed; of more, evenly chosen ones are.
const MOST_IN_SHELL: usize = 100;

/// Samples of the structure factor in shells.
pub struct StructureFactor<const D: usize> {
    largest: f64,
    thickness: f64,
    /// Of each configuration and shell the sum over wave vectors, their number and the sum of their lengths.
    samples: Vec<Vec<[f64; 3]>>,
}

/// The mean of a shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellMean {
    /// Mean length of its wave vectors.
    pub wave_number: f64,
    /// The structure factor.
    pub value: f64,
    /// Half the width of its 95 % interval, with eight configurations or more.
    pub half_width: Option<f64>,
    /// Wave vectors that were summed in a configuration, in the mean; of two that are opposite, one.
    pub vectors: f64,
}

impl<const D: usize> StructureFactor<D> {
    /// No sample yet of so many configurations, of bodies with these radii in a box; nothing without bodies or a periodic axis.
    pub fn new(domain: &Domain<D>, radii: &[f64], configurations: usize) -> Option<StructureFactor<D>> {
        let longest = (0..D).filter(|&axis| domain.periodic(axis)).map(|axis| domain.size[axis]).fold(0.0, f64::max);
        if radii.is_empty() || longest == 0.0 {
            return None;
        }
        let largest = LARGEST * radii.len() as f64 / radii.iter().sum::<f64>();
        let thickness = (THICKNESS * TAU / longest).max(largest / MOST_SHELLS);
        let shells = (largest / thickness) as usize;
        Some(StructureFactor {
            largest: (shells as f64 + 0.5) * thickness,
            thickness,
            samples: vec![vec![[0.0; 3]; shells]; configurations],
        })
    }

    /// Measures the configuration of this number: centres of bodies in the box as it is at their time.
    pub fn add(&mut self, number: usize, domain: &Domain<D>, centers: &[SVector<f64, D>]) {
        let mut counts = vec![0_usize; self.samples[number].len()];
        for_each_wave_vector(domain, self.largest, |vector| {
            if let Some(shell) = self.shell(vector) {
                counts[shell] += 1;
            }
        });
        let mut passed = vec![0_usize; counts.len()];
        for_each_wave_vector(domain, self.largest, |vector| {
            let Some(shell) = self.shell(vector) else { return };
            let [before, after] = [0, 1].map(|next| (passed[shell] + next) * MOST_IN_SHELL.min(counts[shell]) / counts[shell]);
            passed[shell] += 1;
            if after > before {
                let sum = &mut self.samples[number][shell];
                sum.iter_mut().zip([power(vector, centers), 1.0, vector.norm()]).for_each(|(sum, part)| *sum += part);
            }
        });
    }

    fn shell(&self, vector: &SVector<f64, D>) -> Option<usize> {
        let number = (vector.norm() / self.thickness + 0.5) as usize;
        number.checked_sub(1).filter(|shell| self.samples.first().is_some_and(|shells| *shell < shells.len()))
    }

    /// Adds up the configurations of all ranks, each of which has measured others. Collective.
    pub fn sum(&mut self, world: &World) {
        let mut all: Vec<f64> = self.samples.iter().flatten().flatten().copied().collect();
        world.sum(&mut all);
        self.samples.iter_mut().flatten().flatten().zip(all).for_each(|(number, sum)| *number = sum);
    }

    /// Configurations that were measured.
    pub fn configurations(&self) -> usize {
        self.measured().count()
    }

    fn measured(&self) -> impl Iterator<Item = &Vec<[f64; 3]>> {
        self.samples.iter().filter(|shells| shells.iter().any(|[_, vectors, _]| *vectors > 0.0))
    }

    /// The means of all shells that hold wave vectors, the longest last.
    pub fn shells(&self) -> Vec<ShellMean> {
        let count = self.samples.first().map_or(0, Vec::len);
        (0..count).filter_map(|shell| self.mean(shell)).collect()
    }

    fn mean(&self, shell: usize) -> Option<ShellMean> {
        let samples: Vec<[f64; 3]> = self.measured().map(|shells| shells[shell]).filter(|[_, vectors, _]| *vectors > 0.0).collect();
        let [sum, vectors, lengths] = [0, 1, 2].map(|part| samples.iter().map(|sample| sample[part]).sum::<f64>());
        let means: Vec<f64> = samples.iter().map(|[sum, vectors, _]| sum / vectors).collect();
        (vectors > 0.0).then(|| ShellMean {
            wave_number: lengths / vectors,
            value: sum / vectors,
            half_width: interval(&means).map(|interval| interval.half_width),
            vectors: vectors / samples.len() as f64,
        })
    }
}

/// `|sum exp(i k.x)|^2 / N`.
fn power<const D: usize>(vector: &SVector<f64, D>, centers: &[SVector<f64, D>]) -> f64 {
    let (mut sine, mut cosine) = (0.0, 0.0);
    for center in centers {
        let (s, c) = vector.dot(center).sin_cos();
        sine += s;
        cosine += c;
    }
    (sine * sine + cosine * cosine) / centers.len() as f64
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{
        geometry::{Axis, Ball, LeesEdwards},
        observe::PairCounts,
    };

    fn periodic<const D: usize>(size: [f64; D]) -> Domain<D> {
        Domain { size: SVector::from(size), axes: [Axis::Periodic; D] }
    }

    fn sheared<const D: usize>(size: [f64; D], shift: f64) -> Domain<D> {
        let mut domain = periodic(size);
        domain.axes[1] = Axis::Sheared(LeesEdwards::steady(shift, 0.0, 0.0));
        domain
    }

    fn of<const D: usize>(domain: &Domain<D>, radius: f64, centers: &[SVector<f64, D>]) -> Vec<ShellMean> {
        let mut found = StructureFactor::new(domain, &vec![radius; centers.len()], 1).expect("there are bodies in a periodic box");
        found.add(0, domain, centers);
        found.shells()
    }

    /// A square lattice scatters at its own wave vectors alone, all of its `N` bodies in phase.
    #[test]
    fn a_lattice_scatters_where_its_own_wave_vectors_are() {
        let centers: Vec<Vector2<f64>> =
            (0..36).map(|body| Vector2::new(0.3 + 2.0 * f64::from(body % 6), 0.7 + 2.0 * f64::from(body / 6))).collect();
        let lattice = TAU / 2.0;
        for ShellMean { wave_number, value, vectors, .. } in of(&periodic([12.0, 12.0]), 1.0, &centers) {
            // of the vectors in half a plane, (1, 0) and (0, 1) are of the lattice in the shell of length 1, and so on
            let of_lattice = |k: &Vector2<f64>| k.iter().all(|part| (part / lattice - (part / lattice).round()).abs() < 1e-9);
            let (mut all, mut bright) = (0.0, 0.0);
            for_each_wave_vector(&periodic([12.0, 12.0]), LARGEST + 1.0, |k: &Vector2<f64>| {
                if (k.norm() / (0.5 * TAU / 12.0) + 0.5).floor() == (wave_number / (0.5 * TAU / 12.0) + 0.5).floor() {
                    all += 1.0;
                    bright += f64::from(of_lattice(k));
                }
            });
            assert_eq!(all, vectors);
            assert!((value - 36.0 * bright / all).abs() < 1e-9, "{value} at {wave_number}, not 36 times {bright} of {all}");
        }
    }

    /// At each wave vector the structure factor is the sum of cosines over all pairs, whichever images these are: only so for vectors that fit the box.
    fn is_the_sum_over_pairs<const D: usize>(domain: &Domain<D>, centers: &[SVector<f64, D>]) {
        let mut vectors = 0;
        for_each_wave_vector(domain, 4.0, |k| {
            let pairs = (0..centers.len()).flat_map(|one| (0..one).map(move |two| (one, two)));
            let sum: f64 = pairs.map(|(one, two)| k.dot(&domain.nearest_image(centers[one] - centers[two])).cos()).sum();
            let expected = 1.0 + 2.0 * sum / centers.len() as f64;
            assert!((power(k, centers) - expected).abs() < 1e-9, "{} at {k}, not {expected}", power(k, centers));
            vectors += 1;
        });
        // as dense as the box is large: half of those in a disk or ball of this radius
        let ball = if D == 2 { 0.5 * TAU * 16.0 } else { 2.0 / 3.0 * TAU * 64.0 };
        let expected = 0.5 * ball * domain.volume() / TAU.powi(D as i32);
        assert!((f64::from(vectors) / expected - 1.0).abs() < 0.1, "{vectors} vectors, about {expected} expected");
    }

    #[test]
    fn wave_vectors_fit_boxes_whose_images_slide() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for shift in [0.0, 1.3, 7.9, -23.4] {
            let plane = sheared([11.0, 7.0], shift);
            is_the_sum_over_pairs(&plane, &points(&mut random, plane.size, 9));
            let space = sheared([5.0, 7.0, 6.0], shift);
            is_the_sum_over_pairs(&space, &points(&mut random, space.size, 7));
        }
    }

    fn points<const D: usize>(random: &mut ChaCha8Rng, size: SVector<f64, D>, count: usize) -> Vec<SVector<f64, D>> {
        (0..count).map(|_| SVector::from_fn(|axis, _| random.random::<f64>() * size[axis])).collect()
    }

    /// Between walls waves go along them; places of an ideal gas know of nothing.
    #[test]
    fn an_ideal_gas_has_the_structure_factor_1() {
        let mut walled = periodic([16.0, 9.0]);
        walled.axes[1] = Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() };
        for domain in [walled, periodic([16.0, 9.0]), sheared([16.0, 9.0], 3.1)] {
            let mut random = ChaCha8Rng::seed_from_u64(1);
            let mut found = StructureFactor::new(&domain, &[1.0; 50], 64).expect("there are bodies");
            (0..64).for_each(|number| found.add(number, &domain, &points(&mut random, domain.size, 50)));
            let shells = found.shells();
            let outside = shells.iter().filter(|shell| (shell.value - 1.0).abs() > shell.half_width.unwrap_or(0.0)).count();
            assert!(outside * 6 < shells.len(), "{outside} of {} intervals at 95 % do not hold 1", shells.len());
            let mean = shells.iter().map(|shell| shell.value).sum::<f64>() / shells.len() as f64;
            assert!((mean - 1.0).abs() < 0.04 && found.configurations() == 64, "{mean}");
            assert!(domain.periodic(1) || shells.iter().all(|shell| shell.vectors == 1.0));
        }
    }

    /// `S(k) = 1 + 4 pi n int (g - g far away) sin(k r) / k r dr` of spheres put at random where there is room, with the pair distribution as it is counted: of `N` spheres in
    /// all, each sees `n = (N - 1) / V`, and far away `g` is a little above 1 for what they lack near by (Salacuse, Denton and Egelstaff 1996, doi:10.1103/PhysRevE.53.2382).
    #[test]
    fn structure_factor_and_pair_distribution_of_spheres_are_transforms_of_each_other() {
        let (domain, radii, mut random) = (periodic([8.0; 3]), [0.5; 140], ChaCha8Rng::seed_from_u64(11));
        let mut found = StructureFactor::new(&domain, &radii, 60).expect("there are bodies");
        let mut pairs = PairCounts::new(&domain, &radii, None);
        for number in 0..60 {
            let mut centers: Vec<Vector3<f64>> = Vec::new();
            while centers.len() < radii.len() {
                let [center] = points(&mut random, domain.size, 1)[..] else { unreachable!("one point") };
                if centers.iter().all(|other| domain.nearest_image(center - other).norm() > 1.0) {
                    centers.push(center);
                }
            }
            pairs.add(&domain, &centers.iter().map(|&center| Ball { center, radius: 0.5 }).collect::<Vec<_>>());
            found.add(number, &domain, &centers);
        }
        let (density, width) = (139.0 / 512.0, 0.025);
        let distribution = pairs.distribution().expect("there are pairs");
        let distant: Vec<f64> = distribution.radial.iter().filter(|(r, _)| *r > 3.0).map(|(_, g)| *g).collect();
        let far = distant.iter().sum::<f64>() / distant.len() as f64;
        // longer waves do not fit into the sphere of separations that are counted
        let shells = found.shells().into_iter().filter(|shell| (1.0..14.0).contains(&shell.wave_number));
        for ShellMean { wave_number: k, value, .. } in shells {
            let wave = |r: f64| 2.0 * TAU * density * (k * r).sin() / k * r;
            // nothing is nearer than a diameter
            let inside: f64 = (0..4000).map(|part| (f64::from(part) + 0.5) / 4000.0).map(|r| -far * wave(r) / 4000.0).sum();
            let outside: f64 = distribution.radial.iter().map(|&(r, g)| (g - far) * wave(r) * width).sum();
            assert!((1.0 + inside + outside - value).abs() < 0.03, "{value} at {k}, not {}", 1.0 + inside + outside);
        }
    }

    #[test]
    fn of_many_wave_vectors_evenly_chosen_ones_count() {
        let domain = periodic([40.0, 40.0]);
        let shells = of(&domain, 0.5, &points(&mut ChaCha8Rng::seed_from_u64(2), domain.size, 300));
        assert!(shells.iter().all(|shell| shell.vectors <= 100.0) && shells.last().is_some_and(|shell| shell.vectors == 100.0));
        assert!(StructureFactor::new(&domain, &[], 1).is_none());
    }
}
