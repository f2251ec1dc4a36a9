//! Proofs of the projection on one rank, without any: what each file holds its name says.

mod crowds;
mod geometry;
mod impacts;
mod lower_bounds;
mod rebound;
mod refusals;
mod solvers;

use nalgebra::{SVector, Vector2};

use super::{Memory, Problem, ProblemShare, Projection, Spanning, island::solve_island, project::project_by, share::IslandSolver};
use crate::{
    body::Regions,
    error::Result,
    geometry::{Axis, Ball, Domain, LeesEdwards},
    parallel::Peers,
};

/// Gaps that close and sums that vanish are right to this, in radii or in what is summed.
const EXACT: f64 = 1e-12;

/// A problem that owns what it is about.
#[derive(Clone)]
struct Scene<const D: usize> {
    domain: Domain<D>,
    balls: Vec<Ball<D>>,
    weights: Vec<f64>,
    velocities: Vec<SVector<f64, D>>,
    step: f64,
}

impl<const D: usize> Scene<D> {
    /// Balls of radius 1 and weight 1 that move for one unit of time.
    fn new(domain: Domain<D>, bodies: &[([f64; D], [f64; D])]) -> Self {
        let balls = bodies.iter().map(|(center, _)| Ball { center: SVector::from(*center), radius: 1.0 }).collect();
        let velocities = bodies.iter().map(|(_, velocity)| SVector::from(*velocity)).collect();
        Self { domain, balls, weights: vec![1.0; bodies.len()], velocities, step: 1.0 }
    }

    fn problem(&self) -> Problem<'_, D> {
        Problem::new(&self.domain, &self.balls, &self.weights, &self.velocities, self.step)
    }

    fn solve(&self) -> Result<Projection<D>> {
        alone(&self.problem(), &Memory::default(), &|problem, contacts, guess| solve_island(problem, contacts, guess))
    }

    fn moved(&self, projection: &Projection<D>) -> Vec<Ball<D>> {
        let pairs = self.balls.iter().zip(&projection.velocities);
        pairs.map(|(ball, velocity)| Ball { center: ball.center + velocity * self.step, ..*ball }).collect()
    }

    /// Largest overlap after the step, in radii of the smaller of the two, by looking at every pair; bodies do not
    /// leave the box by more than one box length.
    fn overlap(&self, projection: &Projection<D>) -> f64 {
        let (balls, domain) = (self.moved(projection), self.domain.after(self.step));
        let mut largest = 0.0f64;
        for (place, one) in balls.iter().enumerate() {
            for axis in (0..D).filter(|&axis| !self.domain.periodic(axis)) {
                let gap = one.center[axis].min(self.domain.size[axis] - one.center[axis]) - one.radius;
                largest = largest.max(-gap / one.radius);
            }
            for two in &balls[..place] {
                let distance = domain.nearest_image(two.center - one.center).norm();
                largest = largest.max((one.radius + two.radius - distance) / one.radius.min(two.radius));
            }
        }
        largest
    }

    /// `sum w v^2 / 2`.
    fn energy(&self, velocities: &[SVector<f64, D>]) -> f64 {
        let free = self.weights.iter().zip(velocities).filter(|(weight, _)| weight.is_finite());
        free.map(|(weight, velocity)| weight * velocity.norm_squared() / 2.0).sum()
    }
}

/// The projection without other ranks.
fn alone<const D: usize>(problem: &Problem<D>, memory: &Memory<D>, solve: IslandSolver<D>) -> Result<Projection<D>> {
    let regions = Regions::new(problem.domain, 1);
    Ok(project_by(Peers::Alone, &ProblemShare { problem: *problem, regions: &regions, spanning: Spanning::Gathered }, memory, solve)?
        .projection)
}

/// A box with walls along all axes but those that are periodic.
fn domain<const D: usize>(size: [f64; D], periodic: [bool; D]) -> Domain<D> {
    let wall = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    Domain { size: SVector::from(size), axes: periodic.map(|periodic| if periodic { Axis::Periodic } else { wall }) }
}

/// Disks in a row of touching neighbours between walls far away, `y = 50`, the first at `x = 40`.
fn row(count: usize, velocity: impl Fn(usize) -> Vector2<f64>) -> Scene<2> {
    let place = |body: usize| ([40.0 + 2.0 * body as f64, 50.0], velocity(body).into());
    Scene::new(domain([200.0, 100.0], [false, false]), &(0..count).map(place).collect::<Vec<_>>())
}
