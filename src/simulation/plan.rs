//! What a scene calls for, before anything is built.

use std::fmt;

use crate::{
    error::Result,
    flow::{Drive, InverseMethod},
    grid::Grid,
    scene::{ConstraintMethod, ContactModel, FlowModel, Scene, Scheme, Step},
    simulation::{DrySetup, ScalarSetup, Setup, SuspendedBody, closure::Closure, fitted},
    surface::{SurfaceTable, modes},
};

/// Bytes that a nonzero of a sparse matrix takes: value and index.
const BYTES_PER_NONZERO: f64 = 12.0;

/// Operator complexity of a BoomerAMG hierarchy with its copy of the finest matrix.
const HIERARCHY_FACTOR: f64 = 4.0;

/// Iterations of the coupled solver that memory is set aside for.
const KRYLOV_VECTORS: f64 = 80.0;

/// Fluid vectors that a solve by transforms takes: those of the operator, the wave numbers, the flow without bodies.
const TRANSFORM_VECTORS: f64 = 6.0;

/// Bytes for each cell that the factors of lines from wall to wall take.
const WALLED_LINE_BYTES: f64 = 240.0;

/// Bytes that the contact model takes for each body: neighbours, constraints and the factors of a pile's matrix.
const CONTACT_BYTES: f64 = 4e3;

/// Bytes that factors of a matrix in 2D take for each unknown, over the binary logarithm of their number.
const FACTOR_BYTES: f64 = 180.0;

/// Fluid vectors that a run in time keeps to start further solves from.
const REMEMBERED_VECTORS: f64 = 5.0;

/// The effects of a scene with their unknowns and memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    effects: Vec<Effect>,
    fluid: Option<FluidPlan>,
    bytes: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct FluidPlan {
    cells: Vec<usize>,
    blocks: Vec<usize>,
    grid_unknowns: usize,
    multiplier_unknowns: usize,
    closure_unknowns: usize,
}

#[derive(Debug, Clone, PartialEq)]
struct Effect {
    name: &'static str,
    /// What is built for it; nothing if it is off.
    built: Option<String>,
}

impl Effect {
    fn on(name: &'static str, built: String) -> Effect {
        Effect { name, built: Some(built) }
    }

    fn off(name: &'static str) -> Effect {
        Effect { name, built: None }
    }
}

impl Plan {
    /// The plan of a scene of dimension `D` on a number of ranks; builds no matrix and solves nothing.
    ///
    /// # Errors
    /// Bodies, grid or rank count do not fit.
    pub fn of<const D: usize>(scene: &Scene, ranks: usize) -> Result<Plan> {
        let fitted = scene.method.constraint == ConstraintMethod::Fitted;
        match scene.flow.model {
            FlowModel::None => Plan::of_dry(scene, &DrySetup::<D>::of(scene)?),
            FlowModel::Scalar => {
                let setup = ScalarSetup::<D>::of(scene)?;
                if fitted { Plan::of_fitted_scalar(&setup, ranks) } else { Plan::of_scalar(&setup, ranks) }
            }
            FlowModel::Stokes => {
                let setup = Setup::<D>::of(scene)?;
                if fitted { Plan::of_fitted_flow(scene, &setup, ranks) } else { Plan::of_flow(scene, &setup, ranks) }
            }
        }
    }

    /// Makes the mesh: nothing else tells how many elements gaps take.
    fn of_fitted_flow<const D: usize>(scene: &Scene, setup: &Setup<D>, ranks: usize) -> Result<Plan> {
        let (triangles, unknowns) = fitted::flow_size(setup)?;
        let free = setup.bodies.iter().filter(|suspended| suspended.body.free()).count();
        let mut effects = vec![
            Effect::on("stokes flow", format!("{triangles} triangles of second order, one matrix and its factors (MUMPS)")),
            Effect::on("drive", drive(&setup.drive)),
            bodies_that_a_mesh_fits(setup.bodies.len(), &format!("{free} of them free; ")),
            Effect::off("inertia"),
        ];
        effects.extend(in_time(scene));
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        Ok(Plan {
            effects,
            fluid: Some(FluidPlan::of_mesh(&grid, unknowns, Closure::count(&setup.drive, &setup.domain))),
            bytes: factor_bytes(unknowns),
        })
    }

    fn of_fitted_scalar<const D: usize>(setup: &ScalarSetup<D>, ranks: usize) -> Result<Plan> {
        let (triangles, unknowns) = fitted::scalar_size(setup)?;
        let effects = vec![
            Effect::on("scalar", format!("{triangles} triangles of second order, one matrix and its factors (MUMPS)")),
            Effect::on("source", format!("{} outside the inclusions", setup.source)),
            bodies_that_a_mesh_fits(setup.inclusions.len(), ""),
            Effect::off("motion in time"),
        ];
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        Ok(Plan { effects, fluid: Some(FluidPlan::of_mesh(&grid, unknowns, 0)), bytes: factor_bytes(unknowns) })
    }

    fn of_dry<const D: usize>(scene: &Scene, setup: &DrySetup<D>) -> Result<Plan> {
        let free = setup.bodies.iter().filter(|body| body.mass.is_finite()).count();
        let mut effects = vec![
            Effect::off("flow"),
            Effect::on("bodies", format!("{}, {free} of them free", setup.bodies.len())),
            Effect::on("inertia", "masses of the bodies".into()),
        ];
        effects.extend(in_time(scene));
        Ok(Plan { effects, fluid: None, bytes: CONTACT_BYTES * setup.bodies.len() as f64 })
    }

    fn of_scalar<const D: usize>(setup: &ScalarSetup<D>, ranks: usize) -> Result<Plan> {
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        let inclusions = match setup.inclusions.len() {
            0 => Effect::off("inclusions"),
            count => Effect::on("inclusions", format!("{count}, with surface multipliers and corrected stencils (sharp)")),
        };
        let effects = vec![
            Effect::on("scalar", "one matrix, one multigrid hierarchy (hypre)".into()),
            Effect::on("source", format!("{} outside the inclusions", setup.source)),
            inclusions,
            Effect::off("motion in time"),
        ];
        let (grid_unknowns, multiplier_unknowns) = (grid.unknowns(D), setup.multipliers());
        let unknowns = (grid_unknowns + multiplier_unknowns) as f64;
        let nonzeros = grid_unknowns as f64 * (2 * D + 1) as f64 * HIERARCHY_FACTOR;
        let fluid = FluidPlan {
            cells: grid.cells().to_vec(),
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns,
            multiplier_unknowns,
            closure_unknowns: 0,
        };
        Ok(Plan { effects, fluid: Some(fluid), bytes: nonzeros * BYTES_PER_NONZERO + KRYLOV_VECTORS * unknowns * 8.0 })
    }

    fn of_flow<const D: usize>(scene: &Scene, setup: &Setup<D>, ranks: usize) -> Result<Plan> {
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        let mut effects = flow_effects(setup, &grid);
        effects.push(Effect::off("inertia"));
        effects.extend(in_time(scene));
        let fluid = FluidPlan {
            cells: grid.cells().to_vec(),
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns: grid.fluid_unknowns(),
            multiplier_unknowns: setup.bodies.iter().map(mode_count).sum(),
            closure_unknowns: Closure::count(&setup.drive, &setup.domain),
        };
        Ok(Plan { effects, fluid: Some(fluid), bytes: bytes(setup, &grid, scene.time.is_some()) })
    }
}

impl FluidPlan {
    /// A mesh, whose flow a grid shows.
    fn of_mesh<const D: usize>(grid: &Grid<D>, unknowns: usize, closure_unknowns: usize) -> FluidPlan {
        FluidPlan {
            cells: grid.cells().to_vec(),
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns: unknowns - closure_unknowns,
            multiplier_unknowns: 0,
            closure_unknowns,
        }
    }
}

fn bodies_that_a_mesh_fits(count: usize, more: &str) -> Effect {
    match count {
        0 => Effect::off("bodies"),
        count => Effect::on("bodies", format!("{count}, {more}edges of the mesh follow them (fitted)")),
    }
}

fn factor_bytes(unknowns: usize) -> f64 {
    FACTOR_BYTES * unknowns as f64 * (unknowns as f64).log2()
}

/// Effects of motion, which a fluid and dry bodies share.
fn in_time(scene: &Scene) -> Vec<Effect> {
    let motion = scene.time.as_ref().map(|time| {
        let step = match time.step {
            Step::Fixed(step) => format!("steps of {step}"),
            Step::Auto => format!("steps in which no body moves more than {} radii", time.travel),
        };
        let scheme = match time.scheme {
            Scheme::TwoStep => "two-step",
            Scheme::Midpoint => "midpoint",
            Scheme::Euler => "Euler",
        };
        format!("to time {} by the {scheme} rule, {step}", time.end)
    });
    let contact = match scene.contact.model {
        ContactModel::None => None,
        ContactModel::Inelastic => Some("inelastic, one quadratic program a step, split into islands".to_owned()),
    };
    let held = if scene.output.fields { "bodies and fields" } else { "bodies only" };
    let frames = scene.time.as_ref().map(|_| format!("every {}, {held}", scene.frame_interval()));
    let effect = |(name, built)| Effect { name, built };
    [("motion in time", motion), ("lubrication", None), ("contact", contact), ("frames", frames)].into_iter().map(effect).collect()
}

fn mode_count<const D: usize>(suspended: &SuspendedBody<D>) -> usize {
    modes(D, suspended.body.ball.radius, 1.0, suspended.order).count()
}

fn flow_effects<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> Vec<Effect> {
    let hierarchies = distinct_laplacians(grid);
    let free = setup.bodies.iter().filter(|suspended| suspended.body.free()).count();
    vec![
        Effect::on(
            "stokes flow",
            match setup.inverse {
                InverseMethod::Hypre => format!("one matrix a component, {hierarchies} multigrid hierarchies (hypre)"),
                InverseMethod::Transform => "no matrices: exact inverse by Fourier transforms".into(),
            },
        ),
        Effect::on("drive", drive(&setup.drive)),
        match setup.bodies.len() {
            0 => Effect::off("bodies"),
            count => Effect::on("bodies", format!("{count}, {free} of them free; surface multipliers with corrected stencils (sharp)")),
        },
    ]
}

fn distinct_laplacians<const D: usize>(grid: &Grid<D>) -> usize {
    (0..=D).filter(|&field| (0..field).all(|other| !grid.same_laplacian(field, other))).count()
}

fn drive<const D: usize>(drive: &Drive<D>) -> String {
    match drive {
        Drive::Rest => "walls and forces only".into(),
        Drive::MeanVelocity(velocity) => format!("mean velocity {:?}", velocity.as_slice()),
        Drive::PressureGradient(gradient) => format!("pressure gradient {:?}", gradient.as_slice()),
        Drive::BodyForce(force) => format!("body force {:?}", force.as_slice()),
        Drive::Shear(rate) => format!("background shear at rate {rate}"),
    }
}

fn bytes<const D: usize>(setup: &Setup<D>, grid: &Grid<D>, in_time: bool) -> f64 {
    let points = (2 * D + 1) as f64;
    let cells = grid.unknowns(D) as f64;
    let remembered = if in_time { REMEMBERED_VECTORS } else { 0.0 };
    let fluid_vector = grid.fluid_unknowns() as f64 * 8.0;
    let multipliers: f64 = setup.bodies.iter().map(mode_count).sum::<usize>() as f64 * 8.0;
    let bodies: f64 = setup.bodies.iter().map(|suspended| body_bytes(suspended, grid)).sum();
    bodies
        + match setup.inverse {
            InverseMethod::Hypre => {
                let nonzeros = cells * (distinct_laplacians(grid) as f64 * points * HIERARCHY_FACTOR + 4.0 * D as f64);
                nonzeros * BYTES_PER_NONZERO + (KRYLOV_VECTORS + remembered) * (fluid_vector + multipliers)
            }
            InverseMethod::Transform => {
                let walled = if setup.domain.fully_periodic() { 0.0 } else { WALLED_LINE_BYTES };
                cells * walled + TRANSFORM_VECTORS * fluid_vector + (KRYLOV_VECTORS + remembered) * multipliers
            }
        }
}

/// Values of the spread rows, interpolation terms, and the dense blocks of a body and about four neighbours.
fn body_bytes<const D: usize>(suspended: &SuspendedBody<D>, grid: &Grid<D>) -> f64 {
    let count = mode_count(suspended) as f64;
    let cells = suspended.body.ball.radius / grid.mean_spacing();
    let surface = if D == 2 { 2.0 * std::f64::consts::PI * cells } else { 4.0 * std::f64::consts::PI * cells * cells };
    let points = SurfaceTable::<D>::point_count(suspended.body.ball.radius, suspended.order, grid.mean_spacing()) as f64;
    8.0 * count * 2.0 * (D + 1) as f64 * surface
        + 16.0 * points * (D * 4_usize.pow(D as u32)) as f64
        + 5.0 * BYTES_PER_NONZERO * count * count
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Effect { name, built } in &self.effects {
            match built {
                Some(built) => writeln!(f, "built      {name}: {built}")?,
                None => writeln!(f, "not built  {name}")?,
            }
        }
        if let Some(fluid) = &self.fluid {
            writeln!(f, "grid       {:?} cells in {:?} blocks", fluid.cells, fluid.blocks)?;
            writeln!(
                f,
                "unknowns   {} on the grid, {} on surfaces, {} mean values",
                fluid.grid_unknowns, fluid.multiplier_unknowns, fluid.closure_unknowns
            )?;
        }
        write!(f, "memory     about {:.0} MB on all ranks", (self.bytes / 1e6).ceil())
    }
}
