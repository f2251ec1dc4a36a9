//! Runs with inertia, which answer at their ends: forces on bodies at rest once the flow is steady, and how fast free bodies came to be.

use std::time::Instant;

use super::{
    answers::{CalibrationAnswer, EstimatedQuantity, of_bodies},
    estimate::Estimate,
    setting::RefinementLevel,
    steadiness::{STEADY, still_to_come, unresolved},
};
use crate::{
    error::{Error, Result},
    mechanics::FlowSolver,
    motion::{Observation, Simulation},
    petsc::Session,
    scene::Scene,
    system::Solution,
};

/// What a whole run has answered.
pub struct WholeRun {
    /// All that it answers.
    pub answers: Vec<CalibrationAnswer>,
    /// What it took, on a grid of so many cells per radius.
    pub level: RefinementLevel,
    /// Part by which forces on bodies at rest were still to change.
    unsteady: f64,
    /// Cells across the thinnest layer.
    layer: Option<f64>,
}

/// What is followed over a run.
#[derive(Default)]
struct Followed {
    /// Times and sizes of forces on bodies whose motion is given.
    forces: Vec<(f64, f64)>,
    /// The largest magnitude of each component of velocities and spins of free bodies.
    fastest: Vec<f64>,
    iterations: usize,
}

impl Followed {
    fn add<const D: usize>(&mut self, time: f64, flow: &dyn FlowSolver<D>, observation: &Observation<D>, solution: &Solution<D>) {
        let (drag, velocity) = of_bodies(flow.setup(), solution);
        self.forces.push((time, drag.iter().map(|force| force * force).sum::<f64>().sqrt()));
        self.fastest.resize(velocity.len(), 0.0);
        self.fastest.iter_mut().zip(velocity).for_each(|(fastest, velocity)| *fastest = fastest.max(velocity.abs()));
        self.iterations += observation.effort.iterations;
    }
}

impl WholeRun {
    /// Runs a scene with inertia to its end. Collective.
    ///
    /// # Errors
    /// As those of a run.
    pub fn of<const D: usize>(session: &Session, scene: &Scene, cells: f64) -> Result<WholeRun> {
        let (start, mut simulation, mut followed) = (Instant::now(), Simulation::<D>::new(session, scene)?, Followed::default());
        loop {
            let observation = simulation.evaluate(&mut |_, _| {})?;
            let (Some(flow), Some(solution)) = (simulation.suspension(), &observation.solution) else {
                return Err(Error::Diverged("a run with inertia has no flow".into()));
            };
            followed.add(simulation.state().time, flow, &observation, solution);
            if simulation.over() {
                return WholeRun::ended(flow, solution, followed, cells, session.world().max(start.elapsed().as_secs_f64()));
            }
            simulation.step(&observation, &mut |_, _| {})?;
        }
    }

    fn ended<const D: usize>(
        flow: &dyn FlowSolver<D>,
        solution: &Solution<D>,
        followed: Followed,
        cells_per_radius: f64,
        seconds: f64,
    ) -> Result<WholeRun> {
        let mut answers = CalibrationAnswer::all(flow, solution)?;
        let velocities = answers.iter_mut().filter(|answer| answer.quantity == EstimatedQuantity::Velocity);
        velocities.for_each(|answer| answer.values.clone_from(&followed.fastest));
        let (setup, cost) = (flow.setup(), &solution.cost);
        let held = setup.bodies.iter().any(|suspended| !suspended.body.free());
        let layer = flow.evolution_on_grid().map_or(Ok(None), |flow| flow.thinnest_layer())?;
        Ok(WholeRun {
            answers,
            level: RefinementLevel {
                cells_per_radius,
                order: setup.bodies.iter().map(|suspended| suspended.order).max().unwrap_or(0),
                grid_unknowns: cost.grid_unknowns,
                multiplier_unknowns: cost.multiplier_unknowns,
                iterations: followed.iterations,
                seconds,
            },
            unsteady: if held { still_to_come(&followed.forces).unwrap_or(0.0) } else { 0.0 },
            layer: layer.filter(|_| held),
        })
    }

    /// Refuses a flow that still changes at the end by more than a part of the accuracy that is asked for.
    ///
    /// # Errors
    /// It does.
    pub fn refuse_unsteady(&self, scene: &Scene, accuracy: f64) -> Result<()> {
        if self.unsteady <= STEADY * accuracy {
            return Ok(());
        }
        let remedy = format!(
            "is that of a steady flow, and with {} cells per radius forces are to change by {:.1e} after time.end = {}; set a later end, or, where vortices are shed, give \
             [resolution]",
            self.level.cells_per_radius,
            self.unsteady,
            scene.end()
        );
        Err(scene.refuse("accuracy", accuracy, &remedy))
    }

    /// Errors no smaller than those that a grid makes in layers as thin as those of the run, on which all grids may agree.
    pub fn widened(&self, mut estimates: Vec<Estimate>) -> Vec<Estimate> {
        let least = self.layer.map_or(0.0, unresolved);
        let of_flow = |estimate: &&mut Estimate| matches!(estimate.quantity, EstimatedQuantity::Drag | EstimatedQuantity::MeanVelocity);
        estimates.iter_mut().filter(of_flow).for_each(|estimate| estimate.error = estimate.error.max(least));
        estimates
    }
}
