//! A suspension on a fitted mesh: at an instant, or with inertia step by step.
//!
//! With inertia, a solve at a time after the last one is a step by second-order backward differentiation on the mesh as it then is; fluid and disks
//! are one linear system, whose convected velocity is implicit.

use std::time::Instant;

use nalgebra::{SVector, Vector2};

use super::{
    history::MeshHistory,
    interpolation::interpolate,
    plane::{edge_lengths, flat, motions, plane, problem, rigid, spatial, state},
};
use crate::{
    error::{Error, Result},
    fitted::{Load, Loads, Mesh, MeshVelocity, MovingMesh, StokesFlow, StokesNumbering, StokesProblem, System, generate, loads},
    flow::Drive,
    geometry::{Ball, Domain},
    grid::Grid,
    interaction::Wrench,
    mechanics::{
        Evolution, EvolutionOnGrid, FlowSolver, History, HistoryShape, HistoryView, MeshLevel, Resistance,
        unsteady::{first_step, inertia, longest_step},
    },
    petsc::{Direct, Report, Session, Stage, enter},
    setup::{Configuration, Setup},
    system::{Cost, ExtrapolationHistory, ResidualMonitor, Snapshot, Solution, WallForces, check_steady_state},
};

/// Solutions from which a step starts.
const MESH_LEVELS: usize = 2;

/// A suspension in 2D whose flow is found on a mesh that fits the bodies.
pub struct FittedFlow<const D: usize> {
    session: Session,
    setup: Setup<D>,
    grid: Grid<D>,
    domain: Domain<2>,
    /// The last mesh that was made, and the factors for it, which also those that it moves to share.
    moving: Option<(MovingMesh, Option<Direct>)>,
    mesh: Option<Mesh>,
    /// Where the last mesh was made, which a restart needs to make it again.
    past: Option<ExtrapolationHistory<D>>,
    /// The flow of earlier times, with inertia.
    history: Option<MeshHistory>,
    cost: Cost,
}

impl<const D: usize> FittedFlow<D> {
    /// Prepares a setup; meshes are made where bodies are.
    ///
    /// # Errors
    /// The grid on which the flow is shown or the rank count does not fit, or no steady state exists.
    pub fn new(session: &Session, setup: Setup<D>) -> Result<FittedFlow<D>> {
        if !setup.interactions.is_empty() {
            let refused = "method.constraint = \"fitted\": meshes that follow bodies support no interactions; choose another method";
            return Err(Error::refused(refused));
        }
        let history = setup.inertia.is_some().then(MeshHistory::default);
        if history.is_none() {
            check_steady_state(&setup)?;
        }
        let world = session.world();
        let grid = setup.grid(world.size(), world.rank())?;
        let domain = plane(&setup.domain);
        let (session, cost) = (session.clone(), Cost::default());
        Ok(FittedFlow { session, setup, grid, domain, moving: None, mesh: None, past: None, history, cost })
    }

    /// What the last solve cost.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// The mesh of the last solve.
    pub fn mesh(&self) -> Option<&Mesh> {
        self.mesh.as_ref()
    }
}

impl<const D: usize> FlowSolver<D> for FittedFlow<D> {
    fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    fn setup(&self) -> &Setup<D> {
        &self.setup
    }

    fn prepare(&mut self, time: f64, _domain: &Domain<D>, _again: bool) -> Result<()> {
        self.setup.prescribe(time);
        Ok(())
    }

    fn resistance(&self) -> Resistance<'_, D> {
        Resistance::unbounded(&self.setup)
    }

    fn evolution(&self) -> Option<&dyn Evolution<D>> {
        self.history.is_some().then_some(self)
    }

    fn history(&self, _time: f64) -> HistoryView<'_, D> {
        let shape = HistoryShape { mesh_levels: if self.history.is_some() { MESH_LEVELS } else { 0 }, ..HistoryShape::default() };
        HistoryView { past: self.past.as_ref(), levels: Vec::new(), mesh_levels: self.levels_on_mesh(), shape }
    }

    fn restore(&mut self, history: History<D>) -> Result<()> {
        (self.moving, self.past) = (None, history.past);
        if let Some(levels) = &mut self.history {
            let mut restored = history.mesh_levels.into_iter();
            *levels = MeshHistory { current: restored.next(), past: restored.collect() };
        }
        Ok(())
    }

    fn solve_at(&mut self, configuration: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let (stage, start) = (enter(Stage::SetUp), Instant::now());
        if let Some(history) = &mut self.history {
            history.settle(configuration.time);
        }
        let mesh = self.mesh_at(configuration.centers, configuration.time)?;
        self.cost.setup = start.elapsed().as_secs_f64();
        drop(stage);
        let (stage, start) = (enter(Stage::Assembly), Instant::now());
        let motions = motions(&self.setup);
        let inertia = self.history.as_ref().and_then(|history| history.inertia(&self.setup, &mesh, configuration.time));
        let problem = problem(&self.setup, &mesh, &motions, inertia.as_ref());
        let numbering = StokesNumbering::new(&problem);
        if self.history.is_some() && inertia.is_none() {
            let flow = self.at_rest(&problem, &numbering);
            let disks = vec![Load::default(); motions.len()];
            let solution = self.solution(&problem, &flow, Loads { disks, ..Loads::default() })?;
            self.keep(configuration, &mesh, &flow);
            return Ok(Solution { walls: WallForces::none(), ..solution });
        }
        let mut system = System::new(self.session.world(), numbering.unknowns()).in_units(numbering.units(&mesh));
        numbering.assemble(&problem, &mut system)?;
        self.cost.assembly = start.elapsed().as_secs_f64();
        drop(stage);
        let (stage, start) = (enter(Stage::Inverse), Instant::now());
        let mut unused = None;
        let direct = self.moving.as_mut().map_or(&mut unused, |(_, direct)| direct);
        let (found, residual) = system.solve(&self.session, direct)?;
        drop(stage);
        monitor(1, residual);
        self.cost.stages.inverse = start.elapsed().as_secs_f64();
        self.cost.krylov = Report { iterations: 1, residual, seconds: self.cost.stages.inverse };
        self.cost.grid_unknowns = numbering.unknowns();
        let flow = numbering.flow(&problem, &found);
        let solution = self.solution(&problem, &flow, loads(&problem, &flow)?)?;
        self.keep(configuration, &mesh, &flow);
        self.mesh = Some(mesh);
        Ok(solution)
    }
}

impl<const D: usize> Evolution<D> for FittedFlow<D> {
    fn longest_step(&self, pushes: &[Wrench<D>]) -> Result<f64> {
        let of_history = |history: &MeshHistory| match (history.past.is_empty(), history.fastest()) {
            (false, fastest) if fastest > 0.0 => longest_step(&self.setup, self.setup.spacing, fastest),
            (_, fastest) => first_step(&self.setup, self.setup.spacing, fastest, pushes),
        };
        Ok(self.history.as_ref().map_or(f64::INFINITY, of_history))
    }

    fn on_grid(&self) -> Option<&dyn EvolutionOnGrid<D>> {
        None
    }
}

impl<const D: usize> FittedFlow<D> {
    /// The solutions from which a step starts, the last one first.
    fn levels_on_mesh(&self) -> Vec<&MeshLevel> {
        self.history.iter().flat_map(|history| history.current.iter().chain(history.past.first())).collect()
    }

    /// What there is before the first step: disks that move, and a fluid that is at rest or, without walls, has the mean velocity that is given.
    ///
    /// Velocities on walls and surfaces are those of the fluid, not of what moves there from the start on: as parts of its momentum they would be missed or
    /// too much in a layer of half an edge.
    fn at_rest(&self, problem: &StokesProblem, numbering: &StokesNumbering) -> StokesFlow {
        let mut flow = numbering.flow(problem, &vec![0.0; numbering.unknowns()]);
        let free = flow.motions.iter_mut().zip(&self.setup.bodies).zip(&inertia(&self.setup).starts);
        free.filter(|((_, suspended), _)| suspended.body.free()).for_each(|((motion, _), start)| *motion = rigid(start));
        let mean = Vector2::from(problem.mean_velocity.map(Option::unwrap_or_default));
        flow.velocities.fill(if problem.mesh.domain.fully_periodic() { mean } else { Vector2::zeros() });
        flow
    }

    /// The mesh around bodies at these centres: the last one that was made, moved there, or a new one where that would be too distorted.
    fn mesh_at(&mut self, centers: &[SVector<f64, D>], time: f64) -> Result<Mesh> {
        if let Some(past) = self.past.take_if(|_| self.moving.is_none()) {
            let nodes = self.make(&past.last.centers, past.time)?.nodes.len();
            if self.levels_on_mesh().iter().any(|level| level.nodes.len() != nodes) {
                let remedy = "resume with the size and the resolution of the first run";
                return Err(Error::refused(format!("the flow of the checkpoint lies on another mesh than that of the scene; {remedy}")));
            }
        }
        if let Some((moving, _)) = &mut self.moving {
            let flat_centers: Vec<Vector2<f64>> = centers.iter().map(flat).collect();
            if let Some(mesh) = moving.moved(&self.session, &flat_centers)? {
                return Ok(mesh);
            }
        }
        let old = self.moving.take().map(|(moving, _)| moving.into_made());
        let mesh = self.make(centers, time)?;
        if let (Some(history), Some(old), Some((moving, _))) = (&mut self.history, old, &mut self.moving) {
            history.change_mesh(&old, moving, &self.session)?;
        }
        Ok(mesh)
    }

    /// A new mesh.
    fn make(&mut self, centers: &[SVector<f64, D>], time: f64) -> Result<Mesh> {
        // the factors of the last mesh go before those of the new one come
        self.moving = None;
        let radii = self.setup.bodies.iter().map(|suspended| suspended.body.ball.radius);
        let disks: Vec<Ball<2>> = centers.iter().zip(radii).map(|(center, radius)| Ball { center: flat(center), radius }).collect();
        let mesh = generate(&self.domain, &disks, edge_lengths(&self.setup)).map_err(|error| self.on_the_way(error, time))?;
        self.moving = Some((MovingMesh::new(mesh.clone(), centers.iter().map(flat).collect()), None));
        let last = Snapshot { fluid: None, multipliers: Vec::new(), centers: centers.to_vec(), mean_flow: Vec::new() };
        self.past = Some(ExtrapolationHistory { time, last, earlier: None });
        self.cost.meshes += 1;
        Ok(mesh)
    }

    /// A mesh that fitted bodies at the start and no longer does is no fault of the scene's.
    fn on_the_way(&self, error: Error, time: f64) -> Error {
        match error {
            Error::Refused(text) if self.cost.meshes > 0 => Error::Diverged(format!("at time {time} {text}; a shorter time.step may help")),
            error => error,
        }
    }

    /// Keeps what was found for the steps to come, with inertia.
    fn keep(&mut self, configuration: &Configuration<D>, mesh: &Mesh, flow: &StokesFlow) {
        if let Some(history) = &mut self.history {
            let centers = configuration.centers.iter().map(flat).collect();
            history.current = Some(MeshLevel::of(configuration.time, centers, mesh, flow));
        }
    }

    fn solution(&self, problem: &StokesProblem, flow: &StokesFlow, found: Loads) -> Result<Solution<D>> {
        let viscosity = self.setup.viscosity;
        let states = problem.mesh.disks.iter().zip(&flow.motions).zip(&found.disks);
        let gradient = match self.setup.drive {
            Drive::PressureGradient(gradient) => gradient,
            _ => spatial(&(-viscosity * flow.force)),
        };
        Ok(Solution {
            lubrication: None,
            bodies: states.map(|((disk, rigid), load)| state(disk, rigid, load, viscosity)).collect(),
            on_mesh: Some(MeshVelocity::of(problem, flow)),
            fluid: interpolate(&self.session, &self.grid, problem, flow, found.mean_pressure)?,
            mean_velocity: spatial(&found.mean_velocity),
            pressure_gradient: gradient,
            contact_forces: Vec::new(),
            pair_stress: None,
            loads: Vec::new(),
            bond_stress: None,
            bond_forces: Vec::new(),
            cost: self.cost,
            walls: WallForces {
                forces: std::array::from_fn(|axis| {
                    found.walls.get(axis).copied().unwrap_or_default().map(|force| spatial(&(viscosity * force)))
                }),
                complete: true,
            },
        })
    }
}
