//! What a scene calls for: its parts, settled before anything is built. What a plan prints is what is built from it, and nothing else.

use super::interactions;
use crate::{
    dimension::same,
    error::Result,
    interaction::{Interaction, Interactions},
    mechanics::{FittedFlow, FlowSolver, ScalarSetup, Suspension, UnsteadySuspension},
    motion::{GranularSetup, ShiftPeriod, Simulation, longest_step_in_flow},
    parallel::Peers,
    petsc::Session,
    scene::{ConstraintMethod, FlowModel, Scene, TimeSection},
    setup::Setup,
};

/// A scene of dimension `D` resolved: what is solved, and what bodies do to each other besides.
#[derive(Debug, Clone)]
pub struct Plan<const D: usize> {
    /// The scene.
    pub scene: Scene,
    /// What is solved.
    pub model: PlannedModel<D>,
}

/// What is solved, in numbers.
#[derive(Debug, Clone)]
pub enum PlannedModel<const D: usize> {
    /// Bodies without a fluid.
    Granular(GranularSetup<D>),
    /// A scalar around inclusions.
    Scalar(ScalarSetup<D>),
    /// Bodies in a flow.
    Flow(Setup<D>),
}

impl<const D: usize> Plan<D> {
    /// The plan of a scene; builds no matrix and solves nothing.
    ///
    /// # Errors
    /// Bodies do not fit, or the scene asks for steps that are too long for its interactions.
    pub fn of(scene: &Scene) -> Result<Plan<D>> {
        Self::on(Peers::Alone, scene)
    }

    /// The same by ranks that place many bodies together; collective.
    ///
    /// # Errors
    /// The same.
    pub fn on(peers: Peers, scene: &Scene) -> Result<Plan<D>> {
        let model = match scene.flow.model {
            FlowModel::None => PlannedModel::Granular(GranularSetup::on(peers, scene)?),
            FlowModel::Scalar => PlannedModel::Scalar(ScalarSetup::on(peers, scene)?),
            FlowModel::Stokes | FlowModel::NavierStokes => PlannedModel::Flow(Setup::on(peers, scene)?),
        };
        Plan { scene: scene.clone(), model }.checked()
    }

    /// The same with another interaction between bodies.
    ///
    /// # Errors
    /// Steps are too long for it.
    ///
    /// # Panics
    /// For a scalar problem, whose inclusions do not move.
    pub fn with(mut self, interaction: impl Interaction<D> + 'static) -> Result<Plan<D>> {
        let interactions = self.interactions_mut().expect("there are bodies to act on");
        *interactions = std::mem::take(interactions).with(interaction);
        self.checked()
    }

    /// What bodies do to each other, if they can.
    pub fn interactions(&self) -> Option<&Interactions<D>> {
        match &self.model {
            PlannedModel::Granular(setup) => Some(&setup.interactions),
            PlannedModel::Scalar(_) => None,
            PlannedModel::Flow(setup) => Some(&setup.interactions),
        }
    }

    /// The setup of a flow.
    pub fn setup(&self) -> Option<&Setup<D>> {
        match &self.model {
            PlannedModel::Flow(setup) => Some(setup),
            _ => None,
        }
    }

    fn interactions_mut(&mut self) -> Option<&mut Interactions<D>> {
        match &mut self.model {
            PlannedModel::Granular(setup) => Some(&mut setup.interactions),
            PlannedModel::Scalar(_) => None,
            PlannedModel::Flow(setup) => Some(&mut setup.interactions),
        }
    }

    /// The longest step with which interactions are stable; infinite if they limit none.
    pub fn longest_step(&self) -> f64 {
        match &self.model {
            PlannedModel::Granular(setup) => setup.longest_step(),
            PlannedModel::Scalar(_) => f64::INFINITY,
            PlannedModel::Flow(setup) => longest_step_in_flow(setup),
        }
    }

    fn checked(self) -> Result<Plan<D>> {
        if let (Some(interactions), true) = (self.interactions(), self.scene.time.is_some()) {
            interactions::check(&self.scene, interactions, self.longest_step())?;
        }
        self.time()?;
        Ok(self)
    }

    /// The times of the run, if it is one in time: in a sheared box, whose images slide by whole cells, a fixed step and the end are rounded down to that.
    ///
    /// # Errors
    /// One of them is shorter than the shortest step.
    fn time(&self) -> Result<Option<TimeSection>> {
        let (Some(time), Some(setup)) = (&self.scene.time, self.setup()) else { return Ok(self.scene.time.clone()) };
        if setup.domain.slide().is_none() {
            return Ok(Some(time.clone()));
        }
        let period = ShiftPeriod::of(&setup.domain, &setup.grid(1, 0)?);
        period.map_or(Ok(time.clone()), |period| period.round_down(time, setup.inertia.is_some())).map(Some)
    }

    /// The simulation in time that is planned. Collective.
    ///
    /// # Errors
    /// Grid or rank count do not fit.
    ///
    /// # Panics
    /// For a scene without a `[time]` section, and for a scalar problem.
    pub fn simulation(self, session: &Session) -> Result<Simulation<D>> {
        let time = self.time()?.expect("the scene has a [time] section");
        match self.model {
            PlannedModel::Scalar(_) => panic!("a scalar problem has no time"),
            PlannedModel::Granular(setup) => Ok(Simulation::granular(session, setup, time)),
            PlannedModel::Flow(setup) => Ok(Simulation::flowing(session, flow_solver(session, setup)?, time)),
        }
    }
}

impl<const D: usize> Simulation<D> {
    /// Builds what a scene with a `[time]` section calls for, and no more.
    ///
    /// # Errors
    /// Bodies, grid or rank count do not fit.
    pub fn new(session: &Session, scene: &Scene) -> Result<Simulation<D>> {
        session.world().agree(Plan::on(session.world().into(), scene))?.simulation(session)
    }
}

/// The solver that a setup's method of imposing rigidity calls for.
///
/// # Errors
/// Bodies, grid or rank count do not fit, or no steady state exists.
pub fn flow_solver<const D: usize>(session: &Session, setup: Setup<D>) -> Result<Box<dyn FlowSolver<D>>> {
    if D == 2 { same(in_plane(session, same(setup))) } else { same(in_space(session, same(setup))) }
}

fn in_plane(session: &Session, setup: Setup<2>) -> Result<Box<dyn FlowSolver<2>>> {
    solver_of(session, setup)
}

fn in_space(session: &Session, setup: Setup<3>) -> Result<Box<dyn FlowSolver<3>>> {
    solver_of(session, setup)
}

fn solver_of<const D: usize>(session: &Session, setup: Setup<D>) -> Result<Box<dyn FlowSolver<D>>> {
    match setup.constraint {
        ConstraintMethod::Fitted => Ok(Box::new(FittedFlow::new(session, setup)?)),
        _ if setup.inertia.is_some() => Ok(Box::new(UnsteadySuspension::new(session, setup)?)),
        _ => Ok(Box::new(Suspension::new(session, setup)?)),
    }
}
