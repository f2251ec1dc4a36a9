//! What a summary says of the bodies as a whole: forces on those whose motion is given, and velocities of the free ones.

use nalgebra::{SMatrix, SVector};
use serde::Serialize;

use super::TooShort;
use crate::{
    body::{Body, Motion, components},
    motion::Simulation,
    observe::{
        Shear,
        statistics::{Interval, Steady, steady},
    },
    scene::Scene,
    setup::Setup,
    system::{BodyState, Solution},
};

/// Bodies differ by no more than this part.
const ALIKE: f64 = 1e-9;

/// A velocity past bodies is rounding below this part of the largest speed at hand.
const NO_STREAM: f64 = 1e-6;

/// Force of the fluid on the bodies whose motion is given.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceSummary {
    /// How many there are.
    pub bodies: usize,
    /// Mean over them.
    pub mean: Vec<f64>,
    /// Root mean square over them.
    pub root_mean_square: f64,
    /// Mean torque over them, one number in two dimensions; nothing unless one of them turns.
    pub mean_torque: Option<Vec<f64>>,
    /// Mean force along the velocity of the fluid past the bodies, over the drag in an unbounded fluid `6 pi mu a U` (in two dimensions, where there
    /// is none, over `mu U`); nothing unless all have the same radius and velocity in a fluid that is not sheared, and that velocity is more than rounding
    /// beside the others at hand.
    pub drag_ratio: Option<f64>,
}

/// Velocities of the free bodies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VelocitySummary {
    /// How many there are.
    pub bodies: usize,
    /// Mean over them.
    pub mean: Vec<f64>,
    /// Root mean square of what they have beyond the mean.
    pub fluctuation: f64,
    /// How they sink, in a fluid with gravity.
    pub settling: Option<SettlingSummary>,
}

/// How bodies sink.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SettlingSummary {
    /// Mean velocity along gravity.
    pub speed: f64,
    /// Mean of that speed over the steady part of a run in time; nothing while it has none.
    pub mean: Option<MeanSpeed>,
    /// Why a run in time has none.
    pub too_short: Option<TooShort>,
    /// The speed at the end over that of a single body in an unbounded fluid, `F / (6 pi mu a)`; nothing in two dimensions, where there is none, nor for bodies
    /// that differ in weight or radius.
    pub stokes_ratio: Option<f64>,
}

/// A mean over the steady part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeanSpeed {
    /// The mean.
    pub mean: f64,
    /// Lowest and highest value that 95 % confidence leaves.
    pub interval: [f64; 2],
    /// Times where the steady part begins and ends.
    pub times: [f64; 2],
}

impl SettlingSummary {
    /// Adds the mean of a speed over time.
    pub fn attach(&mut self, curve: &[(f64, f64)]) {
        match steady(curve, 0.0) {
            Ok(Steady { from, to, interval: Interval { mean, half_width, .. } }) => {
                self.mean = Some(MeanSpeed { mean, interval: [mean - half_width, mean + half_width], times: [from, to] });
            }
            Err(shortage) => self.too_short = Some(TooShort::of("time", shortage)),
        }
    }
}

impl ForceSummary {
    /// Nothing without bodies whose motion is given.
    pub fn of<const D: usize>(setup: &Setup<D>, solution: &Solution<D>) -> Option<ForceSummary> {
        let given = || setup.bodies.iter().zip(&solution.bodies).filter(|(suspended, _)| !suspended.body.free());
        let count = given().count();
        given().next()?;
        let mean = given().map(|(_, state)| state.force).sum::<SVector<f64, D>>() / count as f64;
        let torque = given().map(|(_, state)| state.torque).sum::<SMatrix<f64, D, D>>() / count as f64;
        let turns = given().any(|(one, _)| spin(&one.body) > 0.0);
        let square = given().map(|(_, state)| state.force.norm_squared()).sum::<f64>() / count as f64;
        let given: Vec<&Body<D>> = given().map(|(one, _)| &one.body).collect();
        Some(ForceSummary {
            bodies: count,
            mean: mean.as_slice().to_vec(),
            root_mean_square: square.sqrt(),
            mean_torque: turns.then(|| components(&torque)),
            drag_ratio: drag_ratio(setup, &given, &solution.mean_velocity, &mean),
        })
    }
}

/// See [`ForceSummary::drag_ratio`]: of bodies in a fluid of this mean velocity on which this is the mean force.
fn drag_ratio<const D: usize>(setup: &Setup<D>, given: &[&Body<D>], flow: &SVector<f64, D>, force: &SVector<f64, D>) -> Option<f64> {
    let (first, radius) = (velocity(given[0]), given[0].ball.radius);
    let alike = given.iter().all(|body| same(body.ball.radius, radius) && velocity(body) == first);
    let sheared = Shear::of(&setup.domain, &setup.drive).is_some();
    let past = flow - first;
    let fastest = given.iter().map(|body| spin(body) * radius).fold(flow.norm().max(first.norm()), f64::max);
    let unit = setup.viscosity * past.norm() * if D == 3 { 6.0 * std::f64::consts::PI * radius } else { 1.0 };
    let ratio = force.dot(&past) / (past.norm() * unit);
    (alike && !sheared && past.norm() > NO_STREAM * fastest && ratio.is_finite()).then_some(ratio)
}

impl VelocitySummary {
    /// Of a flow; nothing without free bodies.
    pub fn of_flow<const D: usize>(scene: &Scene, setup: &Setup<D>, solution: &Solution<D>) -> Option<VelocitySummary> {
        let free = || setup.bodies.iter().zip(&solution.bodies).filter(|(suspended, _)| suspended.body.free());
        let sums = free().fold(Sums::default(), |sums, (_, state): (_, &BodyState<D>)| sums.with(&state.twist.velocity));
        let (first, _) = free().next()?;
        let alone = |body: &Body<D>| match body.motion {
            Motion::Free { force, .. } => force.norm() / (6.0 * std::f64::consts::PI * setup.viscosity * body.ball.radius),
            Motion::Prescribed(_) => 0.0,
        };
        let alike = free().all(|(one, _)| same(alone(&one.body), alone(&first.body)) && same(one.body.ball.radius, first.body.ball.radius));
        let mut summary = sums.summary()?;
        let down = scene.gravity.as_deref().map(SVector::<f64, D>::from_column_slice).filter(|gravity| gravity.norm() > 0.0);
        let drawn = free().any(|(one, _)| alone(&one.body) > 0.0);
        summary.settling = down.filter(|_| drawn).map(|gravity| {
            let speed = SVector::<f64, D>::from_column_slice(&summary.mean).dot(&gravity) / gravity.norm();
            let stokes = (D == 3 && alike).then(|| speed / alone(&first.body));
            SettlingSummary { speed, mean: None, too_short: None, stokes_ratio: stokes.filter(|ratio| ratio.is_finite()) }
        });
        Some(summary)
    }

    /// Of free dry bodies; collective.
    pub fn of_dry<const D: usize>(simulation: &Simulation<D>, world: &crate::parallel::World) -> Option<VelocitySummary> {
        let state = simulation.state();
        let (moving, free) = (simulation.moving(), simulation.free());
        let free = moving.iter().zip(free).filter(|(_, free)| *free);
        let own = free.fold(Sums::<D>::default(), |sums, (moving, _)| sums.with(&moving.twist.velocity));
        let mut numbers = vec![own.count, own.squares];
        numbers.extend(own.total.as_slice());
        state.peers(world).sum(&mut numbers);
        Sums { count: numbers[0], squares: numbers[1], total: SVector::<f64, D>::from_column_slice(&numbers[2..]) }.summary()
    }
}

/// Sums over velocities.
#[derive(Clone, Copy)]
struct Sums<const D: usize> {
    count: f64,
    squares: f64,
    total: SVector<f64, D>,
}

impl<const D: usize> Default for Sums<D> {
    fn default() -> Self {
        Sums { count: 0.0, squares: 0.0, total: SVector::zeros() }
    }
}

impl<const D: usize> Sums<D> {
    fn with(self, velocity: &SVector<f64, D>) -> Self {
        Sums { count: self.count + 1.0, squares: self.squares + velocity.norm_squared(), total: self.total + velocity }
    }

    fn summary(&self) -> Option<VelocitySummary> {
        let mean = self.total / self.count;
        let fluctuation = (self.squares / self.count - mean.norm_squared()).max(0.0).sqrt();
        let summary = VelocitySummary { bodies: self.count as usize, mean: mean.as_slice().to_vec(), fluctuation, settling: None };
        (self.count > 0.0).then_some(summary)
    }
}

fn velocity<const D: usize>(body: &Body<D>) -> SVector<f64, D> {
    match body.motion {
        Motion::Prescribed(twist) => twist.velocity,
        Motion::Free { .. } => SVector::zeros(),
    }
}

/// Size of the spin that is given to a body.
fn spin<const D: usize>(body: &Body<D>) -> f64 {
    match &body.motion {
        Motion::Prescribed(twist) => components(&twist.spin).iter().map(|spin| spin * spin).sum::<f64>().sqrt(),
        Motion::Free { .. } => 0.0,
    }
}

fn same(one: f64, other: f64) -> bool {
    (one - other).abs() <= ALIKE * one.abs().max(other.abs())
}
