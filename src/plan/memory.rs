//! Memory of a run, estimated before anything is built.

use crate::{
    constraint::Size,
    flow::InverseMethod,
    geometry::Ball,
    grid::Grid,
    setup::{Setup, SuspendedBody},
    surface::mode_count,
};

/// Bytes that a nonzero of a sparse matrix takes: value and index.
const BYTES_PER_NONZERO: f64 = 12.0;

/// Operator complexity of a BoomerAMG hierarchy with its copy of the finest matrix.
const HIERARCHY_FACTOR: f64 = 4.0;

/// Iterations of the coupled solver that memory is set aside for.
const KRYLOV_VECTORS: f64 = 80.0;

/// Fluid vectors that a solve by transforms takes: the fluid, transformed in place, and its waves.
const TRANSFORM_VECTORS: f64 = 2.0;

/// Those that it takes besides where there are walls or several ranks: the flow without bodies, and values before they are transformed.
const SEPARATE_VECTORS: f64 = 2.0;

/// Bytes for each cell that the factors of lines from wall to wall take.
const WALLED_LINE_BYTES: f64 = 240.0;

/// Bytes that the contact model takes for each body: neighbours, constraints and the factors of a pile's matrix.
pub const CONTACT_BYTES: f64 = 4e3;

/// Bytes that the program takes on each rank before it holds anything of a scene: about those that runs of a few cells take.
pub const PROGRAM_BYTES: f64 = 7.5e7;

/// Fluid vectors that a run in time keeps to start further solves from.
const REMEMBERED_VECTORS: f64 = 5.0;

/// Fluid vectors of a flow with inertia: four solutions, of three of them the extended flow and its convection, the rows of a step and what they are made of.
const INERTIA_VECTORS: f64 = 14.0;

/// Bytes for each velocity near a body with inertia, of which the rigid motion there is kept.
const NEAR_BYTES: f64 = 72.0;

/// How far from a surface these are, in cells.
const NEAR_CELLS: f64 = 3.5;

/// Bytes that a flow takes on all ranks together.
pub fn bytes<const D: usize>(setup: &Setup<D>, grid: &Grid<D>, counts: &[usize], in_time: bool) -> f64 {
    let points = (2 * D + 1) as f64;
    let cells = grid.unknowns(D) as f64;
    let remembered = if in_time { REMEMBERED_VECTORS } else { 0.0 };
    let fluid_vector = grid.fluid_unknowns() as f64 * 8.0;
    let multipliers = counts.iter().sum::<usize>() as f64 * 8.0;
    let method = setup.method(0.0);
    let size = |(suspended, &count): (&SuspendedBody<D>, &usize)| Size { ball: suspended.body.ball, order: suspended.order, count };
    let bodies: f64 = setup.bodies.iter().zip(counts).map(|body| method.bytes(grid, &size(body))).sum();
    let near = |suspended: &SuspendedBody<D>| {
        let reach = Ball { radius: suspended.body.ball.radius + NEAR_CELLS * grid.mean_spacing(), ..suspended.body.ball };
        NEAR_BYTES * D as f64 * reach.volume() / grid.spacing().product()
    };
    let levels = match setup.inertia {
        Some(_) => INERTIA_VECTORS * fluid_vector + setup.bodies.iter().map(near).sum::<f64>(),
        None => 0.0,
    };
    bodies
        + levels
        + match setup.inverse {
            InverseMethod::Hypre => {
                let nonzeros = cells * (distinct_laplacians(grid) as f64 * points * HIERARCHY_FACTOR + 4.0 * D as f64);
                nonzeros * BYTES_PER_NONZERO + (KRYLOV_VECTORS + remembered) * (fluid_vector + multipliers)
            }
            InverseMethod::Transform if !setup.inverts_exactly() => {
                let nonzeros = cells * (distinct_laplacians(grid) as f64 * points + 4.0 * D as f64);
                nonzeros * BYTES_PER_NONZERO + 8.0 * cells + (KRYLOV_VECTORS + remembered) * (fluid_vector + multipliers)
            }
            InverseMethod::Transform => {
                let walled = if setup.domain.fully_periodic() { 0.0 } else { WALLED_LINE_BYTES };
                let separate = if setup.domain.fully_periodic() && grid.partition().blocks() == 1 { 0.0 } else { SEPARATE_VECTORS };
                let solution = if in_time { 1.0 } else { 0.0 };
                let vectors = TRANSFORM_VECTORS + separate + solution;
                cells * walled + vectors * fluid_vector + (KRYLOV_VECTORS + remembered) * multipliers
            }
        }
}

/// Bytes that a scalar takes on all ranks together.
pub fn scalar_bytes<const D: usize>(grid: &Grid<D>, multipliers: usize) -> f64 {
    let cells = grid.unknowns(D) as f64;
    let nonzeros = cells * (2 * D + 1) as f64 * HIERARCHY_FACTOR;
    nonzeros * BYTES_PER_NONZERO + KRYLOV_VECTORS * (cells + multipliers as f64) * 8.0
}

/// Multipliers of each body.
pub fn multiplier_counts<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> Vec<usize> {
    let method = setup.method(0.0);
    let count = |suspended: &SuspendedBody<D>| {
        let ball = Ball { center: setup.domain.wrap(suspended.body.ball.center), ..suspended.body.ball };
        method.count(grid, &ball, mode_count(D, suspended.order))
    };
    setup.bodies.iter().map(count).collect()
}

/// Fields whose Laplacians differ from those of all fields before them.
pub fn distinct_laplacians<const D: usize>(grid: &Grid<D>) -> usize {
    (0..=D).filter(|&field| (0..field).all(|other| !grid.same_laplacian(field, other))).count()
}
