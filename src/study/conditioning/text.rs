//! What the study found, as tables on the terminal with a sentence of reading for each.

use std::f64::consts::PI;

use super::{
    fluid::{Fluid, MOST_ITERATIONS},
    growth::{Exponent, Growth, of},
    laplacian::{LaplacianSolve, WANTED},
    multipliers::{Constrained, MultiplierGrowth},
    preconditioning::Preconditioning,
    rigidity::Rigidity,
};
use crate::experiment::table::{TableRow, aligned};

/// What is solved, and how it is measured.
pub fn introduction(ranks: usize) -> String {
    let cholesky = match ranks {
        1 => "without fill".to_owned(),
        _ => format!("without fill, of each rank's own diagonal block (block Jacobi): its numbers depend on the {ranks} ranks"),
    };
    format!(
        "How hard the linear systems are as the grid is refined.\n\n\
         Laplacian: -Lap u = f in the unit box (L = 1), u = 0 on its walls, for one velocity component of the staggered grid.\n\
         Conjugate gradients start from zero; iterations and seconds are counted until the error in the energy norm is {WANTED:.0e} of\n\
         the solution's, which is known. Condition numbers are ratios of extreme eigenvalues, from the Lanczos matrix of that solve.\n\
         Incomplete Cholesky: {cholesky}.\n\
         BoomerAMG tuned: as in the fluid solver, made symmetric by backward sweeps on the way up.\n\
         Memory: what set-up leaves allocated on all ranks, counted by the C library."
    )
}

/// Condition numbers of the Laplacian against the exact ones.
pub fn eigenvalues(solves: &[LaplacianSolve]) -> String {
    let row = |solve: &LaplacianSolve| {
        let exact = solve.exact_condition.unwrap_or(f64::NAN);
        vec![
            ("", format!("{}D", solve.dimension)),
            ("1/h", solve.cells.to_string()),
            ("unknowns", solve.unknowns.to_string()),
            ("smallest", format!("{:.3}", solve.smallest)),
            ("largest", format!("{:.1}", solve.largest)),
            ("condition", format!("{:.2}", solve.condition)),
            ("exact", format!("{exact:.2}")),
            ("off by %", format!("{:.4}", 100.0 * (solve.condition / exact - 1.0).abs())),
            ("x (h/L)^2", format!("{:.4}", solve.condition / (solve.cells as f64).powi(2))),
        ]
    };
    let rows: Vec<TableRow> = [2, 3].into_iter().flat_map(|dimension| of(solves, dimension, Preconditioning::None)).map(row).collect();
    format!(
        "1. Eigenvalues of the Laplacian, measured and exact\n\n{}\n\n\
         Reading: the smallest eigenvalue stays, the largest grows, and their ratio is {:.4} (L/h)^2:\n\
         half the spacing, four times the condition number.",
        aligned(0, &rows),
        4.0 / (PI * PI)
    )
}

/// Preconditioners on all grids of a dimension, with exponents at the foot.
pub fn preconditioners(solves: &[LaplacianSolve], growth: &[Growth], dimension: usize) -> String {
    let row = |solve: &LaplacianSolve| {
        vec![
            ("", solve.method.name().to_owned()),
            ("1/h", solve.cells.to_string()),
            ("condition", format!("{:.3}", solve.condition)),
            ("iterations", solve.iterations.to_string()),
            ("promised", solve.promised_iterations.to_string()),
            ("set-up s", format!("{:.4}", solve.setup_seconds)),
            ("solve s", format!("{:.4}", solve.solve_seconds)),
            ("memory MB", format!("{:.2}", solve.bytes / 1e6)),
            ("matrix MB", format!("{:.2}", solve.matrix_bytes / 1e6)),
            ("of bound", format!("{:.2}", solve.bound_taken)),
        ]
    };
    let rows: Vec<TableRow> = Preconditioning::ALL.into_iter().flat_map(|method| of(solves, dimension, method)).map(row).collect();
    let exponents = |growth: &Growth| {
        let Growth { condition, iterations, seconds, .. } = growth;
        let name = growth.method.name().to_owned();
        vec![("", name), ("condition", exponent(condition)), ("iterations", exponent(iterations)), ("solve s", exponent(seconds))]
    };
    let growth: Vec<TableRow> = growth.iter().filter(|growth| growth.dimension == dimension).map(exponents).collect();
    let most = solves.iter().filter(|solve| solve.dimension == dimension).map(|solve| solve.bound_taken).fold(0.0, f64::max);
    let verdict = if most <= 1.0 { "never exceeds it" } else { "exceeds it: something is wrong" };
    format!(
        "{dimension}. Preconditioners of the Laplacian in {dimension}D\n\n{}\n\n\
         exponents of 1/h, fitted to the three finest grids (predicted)\n{}\n\n\
         Reading: Jacobi changes nothing, incomplete Cholesky a factor, and both pay 1/h iterations of h^-{dimension} work each; with multigrid\n\
         iterations hardly change, and the solve costs about as much per unknown on every grid, for more memory and a set-up that counts.\n\
         Seconds grow a little faster than predicted where the grid outgrows the caches.\n\
         After k iterations the Chebyshev bound on the error in the energy norm is 2 ((sqrt(c) - 1)/(sqrt(c) + 1))^k of the first one,\n\
         c the condition number; \"promised\" are the iterations that it needs, \"of bound\" is the largest ratio of error to bound at any\n\
         iteration: the error {verdict}.",
        aligned(20, &rows),
        aligned(20, &growth)
    )
}

fn exponent(exponent: &Exponent) -> String {
    let fitted = exponent.fitted.map_or("-".into(), |fitted| format!("{:.2}", (100.0 * fitted).round() / 100.0 + 0.0));
    format!("{fitted} ({})", exponent.predicted)
}

/// Multipliers of disks.
pub fn multipliers(rows: &[Constrained], growth: &[MultiplierGrowth]) -> String {
    let row = |row: &Constrained| {
        vec![
            ("disks", row.bodies.to_string()),
            ("1/h", row.cells.to_string()),
            ("radius/h", format!("{:.1}", row.cells_per_radius)),
            ("modes K", row.modes.to_string()),
            ("unknowns", row.unknowns.to_string()),
            ("condition", format!("{:.2}", row.condition)),
            ("with prec.", format!("{:.3}", row.preconditioned)),
        ]
    };
    let exponents = |row: &MultiplierGrowth| {
        vec![("disks", row.bodies.to_string()), ("of 1/h", exponent(&row.grid)), ("of K + 1", exponent(&row.modes))]
    };
    format!(
        "4. Multipliers of free disks in a periodic box, the fluid eliminated (condition numbers by singular values of the full matrix)\n\n{}\n\n\
         exponents of the condition number, fitted to three points (predicted)\n{}\n\n\
         Reading: multipliers do not feel the grid. One disk alone has 4 (K + 1), because the mode of order k moves the fluid 1/k as much;\n\
         the preconditioner (each disk alone, then near pairs) takes that away and leaves what many disks do together.",
        aligned(0, &rows.iter().map(row).collect::<Vec<_>>()),
        aligned(0, &growth.iter().map(exponents).collect::<Vec<_>>())
    )
}

/// Other constraint methods.
pub fn rigidity(rows: &[Rigidity]) -> String {
    let row = |row: &Rigidity| {
        vec![
            ("", row.method.to_owned()),
            ("1/h", row.cells.to_string()),
            ("epsilon", row.epsilon.map_or("-".into(), |epsilon| format!("{epsilon:.0e}"))),
            ("unknowns", row.unknowns.to_string()),
            ("condition", format!("{:.2e}", row.condition)),
            ("with prec.", format!("{:.2e}", row.preconditioned)),
        ]
    };
    format!(
        "5. One free disk by the other methods, the fluid eliminated (directions that no row sees are left out)\n\n{}\n\n\
         Reading: the penalty's condition number is 1/epsilon: stresses in equilibrium move nothing and only their compliance tells them\n\
         apart. The preconditioner, an elastic body, leaves no others than these, and no velocity excites them: about 20 iterations whatever\n\
         epsilon and grid. Points inside a body (distributed) grow with 1/h, as they are ever closer on its surface; modes on the surface\n\
         (mean-value, of one order here) do not.",
        aligned(14, &rows.iter().map(row).collect::<Vec<_>>())
    )
}

/// The fluid without bodies.
pub fn fluid(rows: &[Fluid]) -> String {
    let row = |row: &Fluid| {
        vec![
            ("", format!("{}D", row.dimension)),
            ("box", row.name.to_owned()),
            ("1/h", row.cells.to_string()),
            ("hypre", row.hypre.to_string()),
            ("set-up s", format!("{:.3}", row.setup_seconds)),
            ("solve s", format!("{:.3}", row.solve_seconds)),
            ("no precond.", row.plain.map_or(format!("> {MOST_ITERATIONS}"), |iterations| iterations.to_string())),
        ]
    };
    format!(
        "6. The fluid without bodies: velocity and pressure together, iterations to a relative residual of 1e-8\n\n{}\n\n\
         Reading: GMRES with one multigrid cycle for each Laplacian (projection form) takes as many iterations on any grid;\n\
         MINRES with no preconditioner takes more than the scalar Laplacian's 1/h: pressure couples all.",
        aligned(0, &rows.iter().map(row).collect::<Vec<_>>())
    )
}
