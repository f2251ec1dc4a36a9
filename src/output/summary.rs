//! `summary.json`: the numbers of a run.

use serde::Serialize;

use crate::{
    body::components,
    observe::Viscosity,
    parallel::{World, peak_memory_bytes},
    simulation::{BodyState, Cost, Setup, Solution},
};

/// Everything that `summary.json` holds; an effect that the scene does not call for is `null`.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Version of the program.
    pub version: &'static str,
    /// Time reached.
    pub time: f64,
    /// Steps made.
    pub steps: usize,
    /// Part of the box that bodies fill.
    pub fraction: f64,
    /// The bodies.
    pub bodies: Vec<BodySummary>,
    /// The flow.
    pub flow: FlowSummary,
    /// Apparent viscosity over that of the fluid, in a sheared suspension of free bodies.
    pub viscosity: Option<ViscositySummary>,
    /// Contacts: none are modelled yet.
    pub contact: Option<()>,
    /// What it cost.
    pub solver: SolverSummary,
    /// Ranks used.
    pub ranks: usize,
}

/// One body.
#[derive(Debug, Clone, Serialize)]
pub struct BodySummary {
    center: Vec<f64>,
    radius: f64,
    velocity: Vec<f64>,
    spin: Vec<f64>,
    /// By the fluid on the body.
    force: Vec<f64>,
    torque: Vec<f64>,
    /// Row by row.
    stresslet: Vec<Vec<f64>>,
}

/// The flow as a whole.
#[derive(Debug, Clone, Serialize)]
pub struct FlowSummary {
    /// Over the whole box, bodies included, without a background shear.
    mean_velocity: Vec<f64>,
    pressure_gradient: Vec<f64>,
}

/// Apparent viscosity and its parts.
#[derive(Debug, Clone, Serialize)]
pub struct ViscositySummary {
    /// Total.
    pub relative: f64,
    /// From the resolved flow.
    pub hydrodynamic: f64,
    /// From lubrication beyond the resolved flow.
    pub lubrication: Option<f64>,
    /// From contacts.
    pub contact: Option<f64>,
    /// Uncertainty of a mean over time.
    pub interval: Option<f64>,
    /// From the shear stress on the walls: must agree with `relative`.
    pub from_walls: Option<f64>,
}

/// Cost and convergence.
#[derive(Debug, Clone, Serialize)]
pub struct SolverSummary {
    /// Unknowns of the grid.
    pub grid_unknowns: usize,
    /// Unknowns on surfaces.
    pub multiplier_unknowns: usize,
    /// Iterations of the coupled solver.
    pub iterations: usize,
    /// Relative residual reached.
    pub residual: f64,
    /// Matrices, hierarchies, flow without bodies.
    pub setup_seconds: f64,
    /// Jump corrections.
    pub assembly_seconds: f64,
    /// Coupled solver.
    pub solve_seconds: f64,
    /// Of the coupled solver: approximate inverse of the fluid.
    pub inverse_seconds: f64,
    /// Of the coupled solver: matrices of the box.
    pub matrix_seconds: f64,
    /// Of the coupled solver: blocks of the bodies.
    pub body_seconds: f64,
    /// Of the coupled solver: the rest, nearly all of it orthogonalisation.
    pub krylov_seconds: f64,
    /// Sum over the ranks.
    pub peak_memory_bytes: f64,
}

impl Summary {
    /// Collects the numbers; collective. `named` is the scene's name and title.
    pub fn new<const D: usize>(
        named: (&str, &str),
        setup: &Setup<D>,
        (solution, viscosity): (&Solution<D>, Option<Viscosity>),
        cost: &Cost,
        world: &World,
    ) -> Summary {
        let bodies = setup.bodies.iter().zip(&solution.bodies);
        Summary {
            scene: named.0.into(),
            title: named.1.into(),
            version: env!("CARGO_PKG_VERSION"),
            time: 0.0,
            steps: 0,
            fraction: setup.fraction(),
            bodies: bodies.map(|(suspended, state)| BodySummary::new(&suspended.body.ball, state)).collect(),
            flow: FlowSummary {
                mean_velocity: solution.mean_velocity.as_slice().to_vec(),
                pressure_gradient: solution.pressure_gradient.as_slice().to_vec(),
            },
            viscosity: viscosity.map(ViscositySummary::new),
            contact: None,
            solver: SolverSummary::new(cost, world),
            ranks: world.size(),
        }
    }
}

impl BodySummary {
    fn new<const D: usize>(ball: &crate::geometry::Ball<D>, state: &BodyState<D>) -> BodySummary {
        BodySummary {
            center: ball.center.as_slice().to_vec(),
            radius: ball.radius,
            velocity: state.twist.velocity.as_slice().to_vec(),
            spin: components(&state.twist.spin),
            force: state.force.as_slice().to_vec(),
            torque: components(&state.torque),
            stresslet: state.stresslet.row_iter().map(|row| row.iter().copied().collect()).collect(),
        }
    }
}

impl ViscositySummary {
    fn new(viscosity: Viscosity) -> ViscositySummary {
        ViscositySummary {
            relative: viscosity.from_stresslets,
            hydrodynamic: viscosity.from_stresslets,
            lubrication: None,
            contact: None,
            interval: None,
            from_walls: viscosity.from_walls,
        }
    }
}

impl SolverSummary {
    fn new(cost: &Cost, world: &World) -> SolverSummary {
        let mut memory = [peak_memory_bytes()];
        world.sum(&mut memory);
        let slowest = |seconds: f64| world.max(seconds);
        let stages = cost.stages;
        SolverSummary {
            grid_unknowns: cost.grid_unknowns,
            multiplier_unknowns: cost.multiplier_unknowns,
            iterations: cost.krylov.iterations,
            residual: cost.krylov.residual,
            setup_seconds: slowest(cost.setup),
            assembly_seconds: slowest(cost.assembly),
            solve_seconds: slowest(cost.krylov.seconds),
            inverse_seconds: slowest(stages.inverse),
            matrix_seconds: slowest(stages.matrices),
            body_seconds: slowest(stages.bodies),
            krylov_seconds: slowest(cost.krylov.seconds - stages.inverse - stages.matrices - stages.bodies),
            peak_memory_bytes: memory[0],
        }
    }
}
