//! The first steps of a sample: how many of them a run does, and with inertia, where no solve is that of an instant, what a step takes.
//!
//! Steps beyond those of the sample are counted at its last speeds.

use std::time::Instant;

use crate::{
    error::Result,
    mechanics::FlowSolver,
    motion::Simulation,
    petsc::Session,
    plan::flow_solver,
    scene::{Step, TimeSection},
    setup::Setup,
    system::Cost,
};

/// Steps of a sample at most, at least, and seconds after which it takes no further one.
const MOST: usize = 64;
const FEWEST: usize = 4;
const SECONDS: f64 = 4.0;

/// What was seen of a sample.
#[derive(Debug, Clone, Copy)]
pub struct SampledSteps {
    /// What its last step cost.
    pub cost: Cost,
    /// Seconds of set-up.
    pub setup: f64,
    /// Steps that it took.
    pub taken: usize,
    /// Mean seconds of the later half of them, and what of that went to surfaces.
    pub seconds: [f64; 2],
    /// Steps of a whole run on the grid of the scene.
    pub steps: f64,
}

/// A step of a sample.
struct SampledStep {
    length: f64,
    /// Steps that a finer grid takes for it.
    finer: f64,
    seconds: [f64; 2],
    cost: Cost,
}

/// Takes steps of a sample whose cells are some times as long as those of its scene. Collective.
///
/// # Errors
/// The sample cannot be built, or its flow cannot be followed.
pub fn sampled_steps<const D: usize>(session: &Session, sample: Setup<D>, time: &TimeSection, coarser: f64) -> Result<SampledSteps> {
    let (start, world) = (Instant::now(), session.world());
    let mut simulation = Simulation::flowing(session, flow_solver(session, sample)?, time.clone());
    let setup = world.max(start.elapsed().as_secs_f64());
    let mut taken = Vec::new();
    while !simulation.over() && taken.len() < MOST {
        if taken.len() >= FEWEST && world.max(start.elapsed().as_secs_f64()) > SECONDS {
            break;
        }
        taken.push(step(session, &mut simulation, time.step, coarser)?);
    }
    let (time_left, last) = (time.end - simulation.state().time, &taken[taken.len() - 1]);
    let steps = match time.step {
        Step::Fixed(step) => (time.end / step).ceil(),
        Step::Auto => taken.iter().map(|step| step.finer).sum::<f64>() + last.finer * (time_left / last.length).max(0.0),
    };
    let later = &taken[taken.len() / 2..];
    let mean = |part: usize| later.iter().map(|step| step.seconds[part]).sum::<f64>() / later.len() as f64;
    let cost = last.cost;
    Ok(SampledSteps { cost, setup, taken: taken.len(), seconds: [mean(0), mean(1)], steps })
}

fn step<const D: usize>(session: &Session, simulation: &mut Simulation<D>, step: Step, coarser: f64) -> Result<SampledStep> {
    let start = Instant::now();
    let observation = simulation.evaluate(&mut |_, _| {})?;
    let longest = flow(simulation).evolution().map_or(Ok(f64::INFINITY), |evolution| evolution.longest_step(&[]))?;
    let cost = observation.solution.as_ref().expect("a fluid flows").cost;
    let length = simulation.step(&observation, &mut |_, _| {})?.length;
    let times = if step == Step::Auto { (coarser * length / longest).max(1.0).log2().ceil().exp2() } else { 1.0 };
    let seconds = [start.elapsed().as_secs_f64(), cost.stages.bodies];
    Ok(SampledStep { length, finer: times, seconds: seconds.map(|seconds| session.world().max(seconds)), cost })
}

fn flow<const D: usize>(simulation: &Simulation<D>) -> &dyn FlowSolver<D> {
    simulation.suspension().expect("a fluid flows")
}
