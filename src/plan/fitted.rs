//! The plan of a fitted mesh, which is made for it: nothing else tells how many elements gaps take.

use super::{
    Plan,
    effects::{Effect, drive, flow_name, gravity, in_time},
    report::{GridPlan, PlanReport},
};
use crate::{
    error::Result,
    grid::Grid,
    mechanics::{ScalarSetup, fitted},
    setup::Setup,
    system::mean_flow_constraint::MeanFlowConstraint,
};

/// Bytes that factors of a matrix in 2D take for each unknown, over the binary logarithm of their number.
const FACTOR_BYTES: f64 = 180.0;

/// Unknowns of an equilateral mesh for each square on one of its edges: `4 / sqrt(3)` triangles, each with two nodes of velocity and half a
/// corner of pressure.
const UNKNOWNS_PER_CELL: f64 = 2.309 * 4.5;

/// The plan of a flow.
pub fn flow<const D: usize>(plan: &Plan<D>, setup: &Setup<D>, ranks: usize) -> Result<PlanReport> {
    let (triangles, unknowns) = fitted::flow_size(setup)?;
    let free = setup.bodies.iter().filter(|suspended| suspended.body.free()).count();
    let mut effects = vec![
        Effect::on(flow_name(setup), mesh(triangles)),
        Effect::on("pressure", "one unknown for each corner of a triangle".into()),
        Effect { name: "rotation".into(), built: (free > 0).then(|| format!("spins of {free} bodies, which are unknowns")) },
        Effect::on("drive", drive(&setup.drive)),
        bodies(setup.bodies.len(), &format!("{free} of them free, fraction {:.4}; ", setup.fraction())),
        inertia(setup),
        gravity(&plan.scene),
    ];
    effects.extend(in_time(plan));
    let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
    let closure_unknowns = MeanFlowConstraint::count(&setup.drive, &setup.domain);
    Ok(on_mesh(effects, &grid, unknowns, closure_unknowns, ranks))
}

/// Inertia of fluid and bodies.
fn inertia<const D: usize>(setup: &Setup<D>) -> Effect {
    let built = setup.inertia.as_ref().map(|inertia| {
        let built = "the flow of two earlier times at nodes that move along, convection in the matrix, whose factors are new in each step";
        format!("fluid of density {}: {built}", inertia.fluid)
    });
    Effect { name: "inertia".into(), built }
}

/// The plan of a scalar.
pub fn scalar<const D: usize>(setup: &ScalarSetup<D>, ranks: usize) -> Result<PlanReport> {
    let (triangles, unknowns) = fitted::scalar_size(setup)?;
    let mut effects = vec![
        Effect::on("scalar", mesh(triangles)),
        Effect::on("source", format!("{} outside the inclusions", setup.source)),
        bodies(setup.inclusions.len(), ""),
    ];
    effects.extend(["pressure", "gravity", "rotation", "motion in time"].map(Effect::off));
    let grid = Grid::new(&setup.domain, setup.spacing, ranks, 0)?;
    Ok(on_mesh(effects, &grid, unknowns, 0, ranks))
}

fn mesh(triangles: usize) -> String {
    format!("{triangles} triangles of second order, one matrix and its factors (MUMPS)")
}

fn bodies(count: usize, more: &str) -> Effect {
    match count {
        0 => Effect::off("bodies"),
        count => Effect::on("bodies", format!("{count}, {more}edges of the mesh follow them (fitted)")),
    }
}

/// A mesh, whose flow a grid shows.
fn on_mesh<const D: usize>(effects: Vec<Effect>, grid: &Grid<D>, unknowns: usize, closure_unknowns: usize, ranks: usize) -> PlanReport {
    let fluid = GridPlan {
        cells: grid.cells().to_vec(),
        asked: None,
        blocks: grid.partition().ranks().to_vec(),
        grid_unknowns: unknowns - closure_unknowns,
        multiplier_unknowns: 0,
        closure_unknowns,
    };
    PlanReport::new(effects, Some(fluid), factor_bytes(unknowns as f64), ranks)
}

fn factor_bytes(unknowns: f64) -> f64 {
    FACTOR_BYTES * unknowns * unknowns.log2()
}

/// About as many bytes as a mesh takes whose triangles, far from bodies, have edges as long as those of so many square cells.
pub fn bytes_of_cells(cells: f64) -> f64 {
    factor_bytes((UNKNOWNS_PER_CELL * cells).max(2.0))
}
