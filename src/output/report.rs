//! The result of a run in a few lines for people.

use super::Summary;

/// The lines that a run ends with.
pub fn report(summary: &Summary) -> String {
    let solver = &summary.solver;
    let bodies = counted(summary.bodies.len(), "body", "bodies");
    let mut lines = vec![format!("{bodies}, fraction {:.4}, on {}", summary.fraction, counted(summary.ranks, "rank", "ranks"))];
    if let Some(viscosity) = &summary.viscosity {
        let walls = viscosity.from_walls.map_or(String::new(), |walls| format!("   (from the force on the walls: {walls:.4})"));
        lines.push(format!("relative viscosity   {:.4}{walls}", viscosity.relative));
    }
    lines.push(format!("unknowns             {} on the grid, {} on surfaces", solver.grid_unknowns, solver.multiplier_unknowns));
    lines.push(format!("iterations           {} to a residual of {:.1e}", solver.iterations, solver.residual));
    lines.push(format!(
        "seconds              {:.2} set-up, {:.2} jump assembly, {:.2} solve ({:.2} multigrid, {:.2} matrices, {:.2} surfaces, {:.2} Krylov)",
        solver.setup_seconds,
        solver.assembly_seconds,
        solver.solve_seconds,
        solver.inverse_seconds,
        solver.matrix_seconds,
        solver.body_seconds,
        solver.krylov_seconds
    ));
    lines.push(format!("peak memory          {:.0} MB", solver.peak_memory_bytes / 1e6));
    lines.join("\n")
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
