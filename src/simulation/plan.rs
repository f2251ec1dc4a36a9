//! What a setup calls for, before anything is built.

use std::fmt;

use crate::{
    error::Result,
    flow::Drive,
    grid::Grid,
    simulation::{Setup, SuspendedBody, closure::Closure},
    surface::{SurfaceTable, modes},
};

/// Bytes that a nonzero of a sparse matrix takes: value and index.
const BYTES_PER_NONZERO: f64 = 12.0;

/// Operator complexity of a BoomerAMG hierarchy with its copy of the finest matrix.
const HIERARCHY_FACTOR: f64 = 4.0;

/// Iterations of the coupled solver that memory is set aside for.
const KRYLOV_VECTORS: f64 = 80.0;

/// The effects of a scene with their unknowns and memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    effects: Vec<Effect>,
    cells: Vec<usize>,
    blocks: Vec<usize>,
    grid_unknowns: usize,
    multiplier_unknowns: usize,
    closure_unknowns: usize,
    bytes: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Effect {
    name: &'static str,
    /// What is built for it; nothing if it is off.
    built: Option<String>,
}

impl Plan {
    /// The plan of a setup on a number of ranks; builds no matrix and solves nothing.
    ///
    /// # Errors
    /// The grid or the rank count does not fit.
    pub fn of<const D: usize>(setup: &Setup<D>, ranks: usize) -> Result<Plan> {
        let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
        let multiplier_unknowns = setup.bodies.iter().map(mode_count).sum();
        let closure_unknowns = Closure::count(&setup.drive, &setup.domain);
        Ok(Plan {
            effects: effects(setup, &grid),
            cells: grid.cells().to_vec(),
            blocks: grid.partition().ranks().to_vec(),
            grid_unknowns: grid.fluid_unknowns(),
            multiplier_unknowns,
            closure_unknowns,
            bytes: bytes(setup, &grid),
        })
    }
}

fn mode_count<const D: usize>(suspended: &SuspendedBody<D>) -> usize {
    modes(D, suspended.body.ball.radius, 1.0, suspended.order).count()
}

fn effects<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> Vec<Effect> {
    let hierarchies = distinct_laplacians(grid);
    let free = setup.bodies.iter().filter(|suspended| suspended.body.free()).count();
    let on = |name, built: String| Effect { name, built: Some(built) };
    let off = |name| Effect { name, built: None };
    vec![
        on("stokes flow", format!("one matrix a component, {hierarchies} multigrid hierarchies (hypre)")),
        on("drive", drive(&setup.drive)),
        match setup.bodies.len() {
            0 => off("bodies"),
            count => on("bodies", format!("{count}, {free} of them free; surface multipliers with corrected stencils (sharp)")),
        },
        off("motion in time"),
        off("inertia"),
        off("lubrication"),
        off("contact"),
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

fn bytes<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> f64 {
    let points = (2 * D + 1) as f64;
    let cells = grid.unknowns(D) as f64;
    let matrices = cells * (distinct_laplacians(grid) as f64 * points * HIERARCHY_FACTOR + 4.0 * D as f64) * BYTES_PER_NONZERO;
    let vectors = (grid.fluid_unknowns() as f64) * 8.0 * KRYLOV_VECTORS;
    let bodies: f64 = setup.bodies.iter().map(|suspended| body_bytes(suspended, grid)).sum();
    matrices + vectors + bodies
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
        writeln!(f, "grid       {:?} cells in {:?} blocks", self.cells, self.blocks)?;
        writeln!(
            f,
            "unknowns   {} on the grid, {} on surfaces, {} mean values",
            self.grid_unknowns, self.multiplier_unknowns, self.closure_unknowns
        )?;
        write!(f, "memory     about {:.0} MB on all ranks", self.bytes / 1e6)
    }
}
