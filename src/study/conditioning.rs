//! Iterations of the fluid solver against the grid: with hypre they stay, without a preconditioner they grow like `1/h`.

use nalgebra::SVector;

use crate::{
    error::{Error, Result},
    flow::{FluidSystem, HypreInverse, Stokes},
    geometry::{Axis, Domain},
    grid::Grid,
    petsc::{Report, Session},
};

/// Relative residual wanted.
const TOLERANCE: f64 = 1e-8;

/// Iterations after which a solver without preconditioner is given up.
const MOST_ITERATIONS: usize = 5000;

/// Finest grids of the study, in cells per side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConditioningRange {
    /// In 2D.
    pub finest_2d: usize,
    /// In 3D.
    pub finest_3d: usize,
}

/// Prints the table; each grid is twice as fine as the one before.
#[allow(clippy::print_stdout)]
pub fn conditioning(session: &Session, range: &ConditioningRange) -> Result<()> {
    let first = session.world().rank() == 0;
    if first {
        println!("iterations of GMRES for the fluid without bodies, to a relative residual of {TOLERANCE:.0e}\n");
        println!("{:<4} {:<10} {:>6} {:>8} {:>9} {:>9} {:>12}", "", "box", "cells", "hypre", "set-up s", "solve s", "no precond.");
    }
    for walls in 0..=2 {
        for cells in doubling(32, range.finest_2d) {
            let row = row::<2>(session, walls, cells)?;
            print_row(first, 2, walls, cells, &row);
        }
    }
    for walls in 0..=1 {
        for cells in doubling(16, range.finest_3d) {
            let row = row::<3>(session, walls, cells)?;
            print_row(first, 3, walls, cells, &row);
        }
    }
    Ok(())
}

fn doubling(first: usize, last: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(first), |cells| Some(2 * cells)).take_while(move |&cells| cells <= last)
}

/// One grid: with hypre (and its set-up seconds), and without a preconditioner (nothing if given up).
struct Row {
    hypre: Report,
    setup: f64,
    plain: Option<usize>,
}

fn row<const D: usize>(session: &Session, walls: usize, cells: usize) -> Result<Row> {
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let axes = std::array::from_fn(|axis| if axis >= D - walls { still } else { Axis::Periodic });
    let domain = Domain::<D> { size: SVector::repeat(1.0), axes };
    let grid = Grid::new(&domain, 1.0 / cells as f64, session.world().size(), session.world().rank())?;
    let stokes = Stokes::new(session, &grid)?;
    let mut inverse = HypreInverse::new(&stokes, &grid)?;
    let mut rhs = stokes.vector()?;
    for field in 0..=D {
        let mut local = rhs.local_mut()?;
        for (value, index) in local[grid.local_range(field)].iter_mut().zip(grid.block(field).indices()) {
            *value = forcing(field, &grid.position(field, index.map(|index| index as isize)));
        }
    }
    stokes.balance(&mut rhs)?;
    let setup = inverse.setup_seconds();
    let mut x = stokes.vector()?;
    let hypre = FluidSystem { stokes: &stokes, inverse: Some(&mut inverse) }.solve((&rhs, &mut x), TOLERANCE, MOST_ITERATIONS)?;
    x.fill(0.0)?;
    let mut plain = FluidSystem { stokes: &stokes, inverse: None };
    let plain = match plain.solve((&rhs, &mut x), TOLERANCE, MOST_ITERATIONS) {
        Ok(report) => Some(report.iterations),
        Err(Error::Diverged(_)) => None,
        Err(error) => return Err(error),
    };
    Ok(Row { hypre, setup, plain })
}

/// Smooth waves and a step: energy at all scales.
fn forcing<const D: usize>(field: usize, point: &SVector<f64, D>) -> f64 {
    let step = if (point[0] - 0.3).abs() < 0.1 { 1.0 } else { 0.0 };
    (field + 1) as f64 * (7.0 * point[0] + 3.0 * point[D - 1]).sin() + step
}

#[allow(clippy::print_stdout)]
fn print_row(first: bool, dimension: usize, walls: usize, cells: usize, row: &Row) {
    if !first {
        return;
    }
    let name = ["periodic", "channel", "closed"][walls];
    let plain = row.plain.map_or(format!("> {MOST_ITERATIONS}"), |iterations| iterations.to_string());
    println!("{dimension}D   {name:<10} {cells:>6} {:>8} {:>9.3} {:>9.3} {plain:>12}", row.hypre.iterations, row.setup, row.hypre.seconds);
}
