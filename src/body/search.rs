//! Search for a packing: relaxation from anywhere, then growth of stirred bodies.
//!
//! Bodies start anywhere and push each other apart. If that stalls, they start over smaller, are
//! stirred like a hot fluid and grow, step by step, which gives them time to order along walls. The
//! effort is counted in pairs looked at, not in seconds, so that every machine and every rank gets
//! the same packing.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::relaxation::Packing;
use crate::geometry::{Ball, Domain, Levels};

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

/// The search for a packing.
pub(super) struct Search<'a, const D: usize> {
    /// The bodies, the obstacles and the effort left.
    pub crowd: Packing<'a, D>,
    random: ChaCha8Rng,
    obstacles: Levels<'a, D>,
    /// Scale of the radii from which they grow.
    easy_scale: f64,
    /// Largest scale of the radii without overlaps so far.
    best_scale: f64,
}

impl<'a, const D: usize> Search<'a, D> {
    /// Prepares the search; the arguments are those of [`super::pack`].
    pub fn new(domain: &'a Domain<D>, obstacles: &[Ball<D>], radii: &[f64], gap: f64, seed: u64) -> Self {
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
        let crowd = Packing {
            domain,
            centers: centers.chain(obstacles.iter().map(|ball| ball.center)).collect(),
            radii: swollen,
            wall_radii: radii.iter().map(|radius| radius * (1.0 + gap)).collect(),
            movable: radii.len(),
            scale: 1.0,
            margin: WIDE_MARGIN,
            effort: EFFORT.min(LEAST_EFFORT + EFFORT_OF_FEW * radii.len() as u64) + EFFORT_PER_BODY * radii.len() as u64,
        };
        Self { crowd, random: ChaCha8Rng::seed_from_u64(seed), obstacles: places, easy_scale, best_scale: 0.0 }
    }

    /// The centres found, or else the largest scale of the radii that could be packed (0 if none).
    pub fn run(mut self) -> std::result::Result<Vec<SVector<f64, D>>, f64> {
        if !self.succeeds() {
            return Err(self.best_scale);
        }
        let (domain, centers) = (self.crowd.domain, &self.crowd.centers);
        let bodies = &centers[..self.crowd.movable];
        Ok(bodies.iter().map(|&center| domain.wrap(center)).collect())
    }

    /// Looks for a packing until one is found or the effort is spent.
    fn succeeds(&mut self) -> bool {
        self.scatter();
        if self.crowd.relax() {
            return true;
        }
        self.crowd.margin = NARROW_MARGIN;
        while self.crowd.effort > 0 {
            self.scatter();
            if self.grow() {
                return true;
            }
        }
        false
    }

    /// Puts every body at a random place, outside obstacles if that is easy.
    fn scatter(&mut self) {
        for body in 0..self.crowd.movable {
            for _ in 0..100 {
                self.crowd.centers[body] = SVector::from_fn(|axis, _| self.random.random::<f64>() * self.crowd.domain.size[axis]);
                if !self.buried(body) {
                    break;
                }
            }
        }
    }

    /// Whether the centre of a body lies in an obstacle.
    fn buried(&self, body: usize) -> bool {
        let (radii, mut buried) = (&self.crowd.radii[self.crowd.movable..], false);
        let point = Ball { center: self.crowd.centers[body], radius: 0.0 };
        self.obstacles.visit(&point, |obstacle, distance| buried |= distance < radii[obstacle]);
        buried
    }

    /// Lets stirred bodies grow from an easy fraction; returns whether they get their radii before
    /// they are stuck.
    fn grow(&mut self) -> bool {
        let mut reached = self.easy_scale;
        self.crowd.scale = reached;
        if !self.crowd.relax() {
            self.easy_scale *= 0.9;
            return false;
        }
        let mut step = GROWTH;
        while step > STUCK && reached < 1.0 && self.crowd.effort > 0 {
            self.best_scale = self.best_scale.max(reached);
            let centers = self.crowd.centers.clone();
            self.crowd.scale = reached;
            self.stir();
            self.crowd.scale = (reached + step).min(1.0);
            if self.crowd.relax() {
                reached = self.crowd.scale;
            } else {
                self.crowd.centers = centers;
                step /= 2.0;
            }
        }
        reached >= 1.0
    }

    fn stir(&mut self) {
        let velocities = (0..self.crowd.movable)
            .map(|body| {
                let speed = STIRRING_SPEED * self.crowd.scale * self.crowd.radii[body];
                SVector::from_fn(|_, _| speed * (2.0 * self.random.random::<f64>() - 1.0))
            })
            .collect();
        self.crowd.stir(velocities, STIRRING_STEPS);
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
