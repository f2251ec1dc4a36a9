//! What the study found, as tables on the terminal with a sentence of reading for each.

use std::f64::consts::PI;

use super::{
    fluid::{Fluid, MOST_ITERATIONS},
    growth::{Exponent, Growth, of},
    laplacian::{Solve, WANTED},
    method::Method,
    multipliers::{Constrained, MultiplierGrowth},
    rigidity::Rigidity,
};

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
pub fn eigenvalues(solves: &[Solve]) -> String {
    let mut lines = vec![
        "1. Eigenvalues of the Laplacian, measured and exact\n".to_owned(),
        row(["", "1/h", "unknowns", "smallest", "largest", "condition", "exact", "off by %", "x (h/L)^2"]),
    ];
    for solve in [2, 3].into_iter().flat_map(|dimension| of(solves, dimension, Method::None)) {
        let exact = solve.exact_condition.unwrap_or(f64::NAN);
        lines.push(row([
            format!("{}D", solve.dimension),
            solve.cells.to_string(),
            solve.unknowns.to_string(),
            format!("{:.3}", solve.smallest),
            format!("{:.1}", solve.largest),
            format!("{:.2}", solve.condition),
            format!("{exact:.2}"),
            format!("{:.4}", 100.0 * (solve.condition / exact - 1.0).abs()),
            format!("{:.4}", solve.condition / (solve.cells as f64).powi(2)),
        ]));
    }
    lines.push(format!(
        "\nReading: the smallest eigenvalue stays, the largest grows, and their ratio is {:.4} (L/h)^2:\n\
         half the spacing, four times the condition number.",
        4.0 / (PI * PI)
    ));
    lines.join("\n")
}

/// Preconditioners on all grids of a dimension, with exponents at the foot.
pub fn preconditioners(solves: &[Solve], growth: &[Growth], dimension: usize) -> String {
    let heads = ["1/h", "condition", "iterations", "promised", "set-up s", "solve s", "memory MB", "matrix MB", "of bound"];
    let mut lines = vec![format!("{dimension}. Preconditioners of the Laplacian in {dimension}D\n"), format!("{:<20}{}", "", row(heads))];
    for method in Method::ALL {
        for solve in of(solves, dimension, method) {
            lines.push(format!("{:<20}{}", method.name(), row(preconditioner(solve))));
        }
    }
    lines.push(format!(
        "\nexponents of 1/h, fitted to the three finest grids (predicted)\n{:<20}{}",
        "",
        row(["condition", "iterations", "solve s"])
    ));
    for growth in growth.iter().filter(|growth| growth.dimension == dimension) {
        let exponents = [growth.condition, growth.iterations, growth.seconds].map(exponent);
        lines.push(format!("{:<20}{}", growth.method.name(), row(exponents)));
    }
    lines.push(reading(solves, dimension));
    lines.join("\n")
}

fn preconditioner(solve: &Solve) -> [String; 9] {
    [
        solve.cells.to_string(),
        format!("{:.3}", solve.condition),
        solve.iterations.to_string(),
        solve.promised_iterations.to_string(),
        format!("{:.4}", solve.setup_seconds),
        format!("{:.4}", solve.solve_seconds),
        format!("{:.2}", solve.bytes / 1e6),
        format!("{:.2}", solve.matrix_bytes / 1e6),
        format!("{:.2}", solve.bound_taken),
    ]
}

fn exponent(exponent: Exponent) -> String {
    let fitted = exponent.fitted.map_or("-".into(), |fitted| format!("{:.2}", (100.0 * fitted).round() / 100.0 + 0.0));
    format!("{fitted} ({})", exponent.predicted)
}

fn reading(solves: &[Solve], dimension: usize) -> String {
    let most = solves.iter().filter(|solve| solve.dimension == dimension).map(|solve| solve.bound_taken).fold(0.0, f64::max);
    let verdict = if most <= 1.0 { "never exceeds it" } else { "exceeds it: something is wrong" };
    format!(
        "\nReading: Jacobi changes nothing, incomplete Cholesky a factor, and both pay 1/h iterations of h^-{dimension} work each; with multigrid\n\
         iterations hardly change, and the solve costs about as much per unknown on every grid, for more memory and a set-up that counts.\n\
         Seconds grow a little faster than predicted where the grid outgrows the caches.\n\
         After k iterations the Chebyshev bound on the error in the energy norm is 2 ((sqrt(c) - 1)/(sqrt(c) + 1))^k of the first one,\n\
         c the condition number; \"promised\" are the iterations that it needs, \"of bound\" is the largest ratio of error to bound at any\n\
         iteration: the error {verdict}."
    )
}

/// Multipliers of disks.
pub fn multipliers(rows: &[Constrained], growth: &[MultiplierGrowth]) -> String {
    let mut lines = vec![
        "4. Multipliers of free disks in a periodic box, the fluid eliminated (condition numbers by singular values of the full matrix)\n"
            .to_owned(),
        row(["disks", "1/h", "radius/h", "modes K", "unknowns", "condition", "with prec."]),
    ];
    for Constrained { bodies, cells, cells_per_radius, modes, unknowns, condition, preconditioned } in rows {
        lines.push(row([
            bodies.to_string(),
            cells.to_string(),
            format!("{cells_per_radius:.1}"),
            modes.to_string(),
            unknowns.to_string(),
            format!("{condition:.2}"),
            format!("{preconditioned:.3}"),
        ]));
    }
    lines
        .push(format!("\nexponents of the condition number, fitted to three points (predicted)\n{}", row(["disks", "of 1/h", "of K + 1"])));
    for MultiplierGrowth { bodies, grid, modes } in growth {
        lines.push(row([bodies.to_string(), exponent(*grid), exponent(*modes)]));
    }
    lines.push(
        "\nReading: multipliers do not feel the grid. One disk alone has 4 (K + 1), because the mode of order k moves the fluid 1/k as much;\n\
         the preconditioner (each disk alone, then near pairs) takes that away and leaves what many disks do together."
            .to_owned(),
    );
    lines.join("\n")
}

/// Other constraint methods.
pub fn rigidity(rows: &[Rigidity]) -> String {
    let mut lines = vec![
        "5. One free disk by the other methods, the fluid eliminated (directions that no row sees are left out)\n".to_owned(),
        format!("{:<14}{}", "", row(["1/h", "epsilon", "unknowns", "condition", "with prec."])),
    ];
    for Rigidity { method, epsilon, cells, unknowns, condition, preconditioned } in rows {
        let epsilon = epsilon.map_or("-".into(), |epsilon| format!("{epsilon:.0e}"));
        let numbers = [cells.to_string(), epsilon, unknowns.to_string(), format!("{condition:.2e}"), format!("{preconditioned:.2e}")];
        lines.push(format!("{method:<14}{}", row(numbers)));
    }
    lines.push(
        "\nReading: the penalty's condition number is 1/epsilon: stresses in equilibrium move nothing and only their compliance tells them\n\
         apart. The preconditioner, an elastic body, leaves no others than these, and no velocity excites them: about 20 iterations whatever\n\
         epsilon and grid. Points inside a body (distributed) grow with 1/h, as they are ever closer on its surface; modes on the surface\n\
         (mean-value, of one order here) do not."
            .to_owned(),
    );
    lines.join("\n")
}

/// The fluid without bodies.
pub fn fluid(rows: &[Fluid]) -> String {
    let mut lines = vec![
        "6. The fluid without bodies: velocity and pressure together, iterations to a relative residual of 1e-8\n".to_owned(),
        row(["", "box", "1/h", "hypre", "set-up s", "solve s", "no precond."]),
    ];
    for Fluid { dimension, name, cells, hypre, setup_seconds, solve_seconds, plain } in rows {
        lines.push(row([
            format!("{dimension}D"),
            (*name).to_owned(),
            cells.to_string(),
            hypre.to_string(),
            format!("{setup_seconds:.3}"),
            format!("{solve_seconds:.3}"),
            plain.map_or(format!("> {MOST_ITERATIONS}"), |iterations| iterations.to_string()),
        ]));
    }
    lines.push(
        "\nReading: GMRES with one multigrid cycle for each Laplacian (projection form) takes as many iterations on any grid;\n\
         MINRES with no preconditioner takes more than the scalar Laplacian's 1/h: pressure couples all."
            .to_owned(),
    );
    lines.join("\n")
}

/// Cells of a table, right-aligned; an empty or two-letter first cell is narrow.
fn row<const N: usize>(cells: [impl AsRef<str>; N]) -> String {
    let padded = cells.iter().enumerate().map(|(place, cell)| format!("{:>1$}", cell.as_ref(), if place == 0 { 8 } else { 12 }));
    padded.collect()
}
