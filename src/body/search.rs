//! Search for a packing: relaxation from anywhere, then growth of stirred bodies.
//!
//! Bodies start anywhere and push each other apart. If that stalls, they start over smaller, are
//! stirred like a hot fluid and grow, step by step, which gives them time to order along walls. The
//! effort is counted in pairs looked at, not in seconds, so that every machine and every rank gets
//! the same packing.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    relaxation::Packing,
    share::{BLOCK, BodyShare},
};
use crate::{
    geometry::{Ball, Domain, Levels},
    parallel::Peers,
};

/// Pair evaluations spent at most, some seconds, and by few bodies.
const EFFORT: u64 = 300_000_000;
const LEAST_EFFORT: u64 = 20_000_000;
const EFFORT_OF_FEW: u64 = 2_000_000;
/// Pair evaluations spent at most in addition, for each body.
const EFFORT_PER_BODY: u64 = 20_000;
/// First step of the growth of the radii, relative to the final radii.
const GROWTH: f64 = 0.02;
/// Step of the growth below which bodies are stuck.
const STUCK: f64 = 5e-4;
/// Fraction from which radii grow, easy to reach in any dimension.
const EASY_FRACTION: f64 = 0.4;
/// Excess of the target over the required distance: at once, and while radii grow.
const WIDE_MARGIN: f64 = 0.01;
const NARROW_MARGIN: f64 = 0.003;
/// Largest speed along each axis when stirred, in radii; collisions overlap by several times that.
const STIRRING_SPEED: f64 = 0.02;
/// Steps of stirring before each growth.
const STIRRING_STEPS: usize = 1500;

/// Columns by which bodies of a row are sorted.
const COLUMNS: f64 = 1e9;

/// The search for a packing.
pub(super) struct Search<'a, const D: usize> {
    /// The bodies, the obstacles and the effort left.
    pub packing: Packing<'a, D>,
    random: ChaCha8Rng,
    /// Radii in the order asked for, without gaps.
    radii: &'a [f64],
    gap: f64,
    /// The place in that order of each body of the crowd.
    numbers: Vec<usize>,
    obstacles: Levels<'a, D>,
    /// Scale of the radii from which they grow.
    easy_scale: f64,
    /// Largest scale of the radii without overlaps so far.
    best_scale: f64,
}

impl<'a, const D: usize> Search<'a, D> {
    /// Prepares the search; the arguments are those of [`super::pack`].
    pub fn new(peers: Peers<'a>, domain: &'a Domain<D>, obstacles: &[Ball<D>], radii: &'a [f64], gap: f64, seed: u64) -> Self {
        let own_radii = radii.iter().copied();
        let swollen: Vec<_> = own_radii.chain(obstacles.iter().map(|ball| ball.radius)).map(|radius| radius * (1.0 + gap / 2.0)).collect();
        let (bodies, fixed) = swollen.split_at(radii.len());
        let free = (1.0 - fraction(domain, fixed)).max(0.1);
        let full = fraction(domain, bodies) / free;
        let mut easy_scale = 1.0;
        while full * power::<D>(easy_scale) > EASY_FRACTION {
            easy_scale *= 0.98;
        }
        let centers = radii.iter().map(|_| SVector::zeros());
        let mut places = Levels::new(domain);
        for (number, (obstacle, &radius)) in obstacles.iter().zip(fixed).enumerate() {
            places.insert(number, &Ball { center: obstacle.center, radius });
        }
        let packing = Packing {
            domain,
            share: BodyShare::new(peers, radii.len()),
            centers: centers.chain(obstacles.iter().map(|ball| ball.center)).collect(),
            radii: swollen,
            wall_radii: radii.iter().map(|radius| radius * (1.0 + gap)).collect(),
            movable: radii.len(),
            scale: 1.0,
            margin: WIDE_MARGIN,
            effort: EFFORT.min(LEAST_EFFORT + EFFORT_OF_FEW * radii.len() as u64) + EFFORT_PER_BODY * radii.len() as u64,
        };
        let (random, numbers) = (ChaCha8Rng::seed_from_u64(seed), (0..radii.len()).collect());
        Self { packing, random, radii, gap, numbers, obstacles: places, easy_scale, best_scale: 0.0 }
    }

    /// The centres found, or else the largest scale of the radii that could be packed (0 if none).
    pub fn run(mut self) -> std::result::Result<Vec<SVector<f64, D>>, f64> {
        if !self.succeeds() {
            return Err(self.best_scale);
        }
        let mut centers = vec![SVector::zeros(); self.packing.movable];
        for (&number, &center) in self.numbers.iter().zip(&self.packing.centers) {
            centers[number] = self.packing.domain.wrap(center);
        }
        Ok(centers)
    }

    /// Looks for a packing until one is found or the effort is spent.
    fn succeeds(&mut self) -> bool {
        self.scatter(false);
        if self.packing.relax() {
            return true;
        }
        self.packing.margin = NARROW_MARGIN;
        while self.packing.effort > 0 {
            // a body that starts among obstacles which lie closely stays there
            self.scatter(true);
            if self.grow() {
                return true;
            }
        }
        false
    }

    /// Puts every body at a random place: its centre, or all of it, outside obstacles if that is easy.
    fn scatter(&mut self, whole: bool) {
        let mut bodies: Vec<_> = (0..self.packing.movable)
            .map(|number| (self.random_place(if whole { self.radii[number] * (1.0 + self.gap / 2.0) } else { 0.0 }), number))
            .collect();
        if bodies.len() > BLOCK {
            let rows = CellRows::new(self.packing.domain, bodies.len());
            bodies.sort_by_cached_key(|(place, _)| rows.key(place));
        }
        self.numbers = bodies.iter().map(|&(_, number)| number).collect();
        for (body, (place, number)) in bodies.into_iter().enumerate() {
            let radius = self.radii[number];
            self.packing.centers[body] = place;
            self.packing.radii[body] = radius * (1.0 + self.gap / 2.0);
            self.packing.wall_radii[body] = radius * (1.0 + self.gap);
        }
    }

    /// A place in the box at this distance from obstacles if that is easy.
    fn random_place(&mut self, radius: f64) -> SVector<f64, D> {
        let size = self.packing.domain.size;
        let mut place = || SVector::from_fn(|axis, _| self.random.random::<f64>() * size[axis]);
        let mut found = place();
        for _ in 1..100 {
            if !buried(&self.obstacles, &self.packing, &Ball { center: found, radius }) {
                break;
            }
            found = place();
        }
        found
    }

    /// Lets stirred bodies grow from an easy fraction; returns whether they get their radii before
    /// they are stuck.
    fn grow(&mut self) -> bool {
        let mut reached = self.easy_scale;
        self.packing.scale = reached;
        if !self.packing.relax() {
            self.easy_scale *= 0.9;
            return false;
        }
        let mut step = GROWTH;
        while step > STUCK && reached < 1.0 && self.packing.effort > 0 {
            self.best_scale = self.best_scale.max(reached);
            let centers = self.packing.centers.clone();
            self.packing.scale = reached;
            self.stir();
            self.packing.scale = (reached + step).min(1.0);
            if self.packing.relax() {
                reached = self.packing.scale;
            } else {
                self.packing.centers = centers;
                step /= 2.0;
            }
        }
        reached >= 1.0
    }

    fn stir(&mut self) {
        let mut velocities = Vec::with_capacity(self.packing.share.own.len());
        for body in 0..self.packing.movable {
            let speed = STIRRING_SPEED * self.packing.scale * self.packing.radii[body];
            let velocity = SVector::from_fn(|_, _| speed * (2.0 * self.random.random::<f64>() - 1.0));
            velocities.extend(self.packing.share.own.contains(&body).then_some(velocity));
        }
        self.packing.stir(velocities, STIRRING_STEPS);
    }
}

/// Whether a ball overlaps an obstacle; of a point, whether it lies in one.
fn buried<const D: usize>(obstacles: &Levels<D>, packing: &Packing<D>, ball: &Ball<D>) -> bool {
    let (centers, radii) = (&packing.centers[packing.movable..], &packing.radii[packing.movable..]);
    let mut buried = false;
    obstacles.visit_within(ball, 1.0, |obstacle| {
        let distance = packing.domain.nearest_image(centers[obstacle] - ball.center).norm();
        buried |= distance < radii[obstacle] + ball.radius;
    });
    buried
}

/// Rows of the box along the first axis: bodies in their order lie near those before and after them.
struct CellRows<const D: usize> {
    size: SVector<f64, D>,
    /// Rows along each axis; many places in a row.
    counts: SVector<f64, D>,
}

impl<const D: usize> CellRows<D> {
    /// Rows for so many bodies, two or three of them wide.
    fn new(domain: &Domain<D>, bodies: usize) -> Self {
        let width = 2.0 * (domain.volume() / bodies as f64).powf(1.0 / D as f64);
        let counts = SVector::from_fn(|axis, _| if axis == 0 { COLUMNS } else { (domain.size[axis] / width).ceil() });
        Self { size: domain.size, counts }
    }

    /// What points are sorted by: the last axis first.
    fn key(&self, point: &SVector<f64, D>) -> [u32; D] {
        std::array::from_fn(|axis| D - 1 - axis).map(|axis| (point[axis] / self.size[axis] * self.counts[axis]) as u32)
    }
}

/// Part of the box that balls of these radii fill.
pub(super) fn fraction<const D: usize>(domain: &Domain<D>, radii: &[f64]) -> f64 {
    let volume = |&radius| Ball::<D> { center: SVector::zeros(), radius }.volume();
    radii.iter().map(volume).sum::<f64>() / domain.volume()
}

/// `number^D` by products, which round alike on every platform.
pub(super) fn power<const D: usize>(number: f64) -> f64 {
    (0..D).fold(1.0, |product, _| product * number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Axis;

    /// Pairs looked at for each of the bodies that fill a part of a box.
    fn effort_a_body<const D: usize>(count: usize, asked: f64) -> f64 {
        let mut domain = Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; D] };
        let radii = vec![0.5; count];
        domain.size *= (fraction(&domain, &radii) / asked).powf(1.0 / D as f64);
        let mut search = Search::new(Peers::Alone, &domain, &[], &radii, 0.02, 1);
        let effort = search.packing.effort;
        assert!(search.succeeds());
        (effort - search.packing.effort) as f64 / count as f64
    }

    /// More bodies relax in more steps, for the worst place among more is worse: by a third from a thousand to thirty thousand.
    #[test]
    fn the_effort_for_a_body_hardly_grows_with_their_number() {
        let disks = [1_000, 32_000].map(|count| effort_a_body::<2>(count, 0.5));
        let spheres = [1_000, 32_000].map(|count| effort_a_body::<3>(count, 0.3));
        for [few, many] in [disks, spheres] {
            assert!(many < 2.0 * few, "{many} after {few}");
        }
    }
}
