//! The seconds that a run will take, from a sample of it that is solved on the spot.
//!
//! The sample has at most forty of the scene's bodies at its fraction, its kinds of axes and its inverse, and a coarse grid if it has all
//! the bodies or would have many cells; a box that is still too large or too long is cut. Set-up and what an iteration does on the grid take
//! seconds in proportion to its unknowns (Fourier transforms also by the lengths of the axes, some of which suit them badly), what it does on
//! surfaces in proportion to multipliers and the rows about each surface; the number of iterations grows little with that of bodies. It does not know how a run ends: steps are
//! counted at the speeds of the sample; with inertia, or if the sample has all bodies, its first steps are taken, and further ones counted at the speeds
//! to which these come.

mod growth;
mod sample;
mod steps;

use nalgebra::SVector;

use self::{
    growth::Growth,
    sample::sample,
    steps::{SampledSteps, sampled_steps},
};
use crate::{
    error::{Error, Result},
    geometry::Ball,
    mechanics::FlowSolver,
    motion::time_of_travel,
    petsc::Session,
    plan::flow_solver,
    scene::{Scene, Scheme, Step, TimeSection},
    setup::{Configuration, Setup, SuspendedBody},
    system::{BodyState, Solution},
};

/// Cells by which the bodies of a sample are displaced: next to none, for beside walls there may be no room.
const DISPLACEMENT: f64 = 1e-6;

/// Iterations of a step in time over those of an instant: steps start from the solutions before them.
const WARM: f64 = 0.5;

/// What a run is expected to take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Seconds of set-up, once.
    pub setup: f64,
    /// Seconds of a solve at an instant, jump corrections included; with inertia of a step.
    pub solve: f64,
    /// Its iterations.
    pub iterations: usize,
    /// Solves of a run in time; nothing at an instant.
    pub solves: Option<f64>,
    /// Seconds of each solve but the first over those of the first.
    further: f64,
    /// Steps that a sample took, if it took any.
    pub sampled: Option<usize>,
}

impl Forecast {
    /// Of a scene of dimension `D` with a flow, a resolution, and so many unknowns of the grid and multipliers; nothing if no sample of it can be solved. Collective.
    ///
    /// # Errors
    /// The scene cannot be built, or PETSc fails.
    pub fn of<const D: usize>(session: &Session, scene: &Scene, grid: usize, multipliers: usize) -> Result<Option<Forecast>> {
        let setup = session.world().agree(Setup::<D>::of(scene))?;
        let Some(sample) = sample(&setup) else { return Ok(None) };
        let forecast = match (&setup.inertia, &scene.time) {
            (Some(_), Some(time)) => Forecast::of_steps(session, &setup, sample.clone(), time, (grid, multipliers)),
            _ => Forecast::of_an_instant(session, &setup, sample.clone(), scene.time.as_ref(), (grid, multipliers)),
        };
        let all = sample.bodies.len() == setup.bodies.len() && setup.inertia.is_none();
        let forecast = match (forecast, &scene.time) {
            (Ok(forecast), Some(time)) if all && time.step == Step::Auto => forecast.stepped(session, sample, time),
            (forecast, _) => forecast,
        };
        match forecast {
            // a sample need not have the flow that the scene has
            Err(Error::Refused(_) | Error::Diverged(_) | Error::StepTooLong { .. }) => Ok(None),
            forecast => forecast.map(Some),
        }
    }

    /// From a solve of a sample.
    fn of_an_instant<const D: usize>(
        session: &Session,
        setup: &Setup<D>,
        sample: Setup<D>,
        time: Option<&TimeSection>,
        unknowns: (usize, usize),
    ) -> Result<Forecast> {
        let most = |value: f64| session.world().max(value);
        let mut suspension = flow_solver(session, sample)?;
        // once more, elsewhere: tables for each kind of pair are made once a run
        let first = suspension.solve(&mut |_, _| {})?.cost.assembly;
        let solution = elsewhere(suspension.as_mut())?;
        let cost = &solution.cost;
        let growth = Growth::of(setup, unknowns, suspension.setup(), cost);
        let [setup_seconds, assembly, krylov, surfaces] = [cost.setup, cost.assembly, cost.krylov.seconds, cost.stages.bodies].map(most);
        let solved = suspension.setup();
        let ball = |(body, of): (&BodyState<D>, &SuspendedBody<D>)| Ball { center: body.center, radius: of.body.ball.radius };
        let balls: Vec<Ball<D>> = solution.bodies.iter().zip(&solved.bodies).map(ball).collect();
        let velocities: Vec<SVector<f64, D>> = solution.bodies.iter().map(|body| body.twist.velocity).collect();
        let travel = -most(-time_of_travel(&solved.domain, &balls, &velocities));
        Ok(Forecast {
            setup: setup_seconds * growth.grid + most(first - assembly).max(0.0),
            solve: assembly * growth.bodies + growth.solve(krylov, surfaces),
            iterations: (cost.krylov.iterations as f64 * growth.iterations).round() as usize,
            solves: time.map(|time| solves(time, travel)),
            further: WARM,
            sampled: None,
        })
    }

    /// With the solves to which the first steps of a sample of all bodies come; as it is if they cannot be taken. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    fn stepped<const D: usize>(self, session: &Session, sample: Setup<D>, time: &TimeSection) -> Result<Forecast> {
        match sampled_steps(session, sample, time, 1.0) {
            Ok(SampledSteps { taken, steps, .. }) => Ok(Forecast { solves: Some(solves_of(time, steps)), sampled: Some(taken), ..self }),
            Err(Error::Refused(_) | Error::Diverged(_) | Error::StepTooLong { .. }) => Ok(self),
            Err(error) => Err(error),
        }
    }

    /// Whether all solves are like the first.
    pub fn even(&self) -> bool {
        self.further == 1.0
    }

    /// From the first steps of a sample with inertia.
    fn of_steps<const D: usize>(
        session: &Session,
        setup: &Setup<D>,
        sample: Setup<D>,
        time: &TimeSection,
        unknowns: (usize, usize),
    ) -> Result<Forecast> {
        let SampledSteps { cost, setup: setup_seconds, taken, seconds, steps } =
            sampled_steps(session, sample.clone(), time, sample.spacing / setup.spacing)?;
        let growth = Growth::of(setup, unknowns, &sample, &cost);
        Ok(Forecast {
            setup: setup_seconds * growth.grid,
            solve: cost.assembly * growth.bodies + growth.solve((seconds[0] - cost.assembly).max(0.0), seconds[1]),
            iterations: (cost.krylov.iterations as f64 * growth.iterations).round() as usize,
            solves: Some(steps),
            further: 1.0,
            sampled: Some(taken),
        })
    }

    /// Seconds of each solve but the first.
    pub fn of_further(&self) -> f64 {
        self.further * self.solve
    }

    /// All seconds.
    pub fn seconds(&self) -> f64 {
        self.setup + self.solve + self.solves.map_or(0.0, |solves| self.of_further() * (solves - 1.0).max(0.0))
    }
}

/// Solves with all bodies displaced by a part of a cell.
fn elsewhere<const D: usize>(suspension: &mut dyn FlowSolver<D>) -> Result<Solution<D>> {
    let setup = suspension.setup();
    let centers: Vec<SVector<f64, D>> =
        setup.bodies.iter().map(|suspended| suspended.body.ball.center + SVector::repeat(DISPLACEMENT * setup.spacing)).collect();
    let welds = setup.interactions.welds(&centers);
    let moment = Configuration::at_rest(setup, &centers, &welds);
    suspension.solve_at(&moment, &mut |_, _| {})
}

/// Solves of a run in which bodies move by what they may in a time.
fn solves(time: &TimeSection, travel: f64) -> f64 {
    let steps = match time.step {
        Step::Fixed(step) => time.end / step,
        Step::Auto => time.end / (time.travel * travel),
    };
    solves_of(time, steps)
}

/// Solves of so many steps of a flow without inertia.
fn solves_of(time: &TimeSection, steps: f64) -> f64 {
    let solves = if time.scheme == Scheme::Midpoint { 2.0 } else { 1.0 };
    solves * steps.ceil() + 1.0
}
