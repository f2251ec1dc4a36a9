//! Iterations of the fluid solver against the grid: with hypre they stay, without a preconditioner they grow at least like `1/h`.

use std::ops::Range;

use nalgebra::SVector;

use crate::{
    error::{Error, Result},
    flow::{FluidSystem, HypreInverse, Stokes},
    geometry::{Axis, Domain},
    grid::Grid,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Report, Session, System, Vector},
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
        println!(
            "iterations for the fluid without bodies to a relative residual of {TOLERANCE:.0e}:\nGMRES with hypre in projection form, MINRES with no preconditioner\n"
        );
        println!("{:<4} {:<10} {:>6} {:>8} {:>9} {:>9} {:>12}", "", "box", "cells", "hypre", "set-up s", "solve s", "no precond.");
    }
    for walls in 0..=2 {
        table::<2>(session, walls, doubling(32, range.finest_2d))?;
    }
    for walls in 0..=1 {
        table::<3>(session, walls, doubling(16, range.finest_3d))?;
    }
    Ok(())
}

/// The rows of one box, and how iterations grow.
#[allow(clippy::print_stdout)]
fn table<const D: usize>(session: &Session, walls: usize, grids: impl Iterator<Item = usize>) -> Result<()> {
    let first = session.world().rank() == 0;
    let (mut with_hypre, mut plain) = (Vec::new(), Vec::new());
    for cells in grids {
        let row = row::<D>(session, walls, cells)?;
        print_row(first, D, walls, cells, &row);
        with_hypre.push((cells, row.hypre.iterations));
        plain.extend(row.plain.map(|iterations| (cells, iterations)));
    }
    if let (true, Some(hypre), Some(plain)) = (first, growth(&with_hypre), growth(&plain)) {
        println!("{:>47}", format!("grow like h^-{hypre:.2} with hypre, h^-{plain:.2} without\n"));
    }
    Ok(())
}

/// Exponent of the growth of iterations with the number of cells, from the coarsest to the finest grid.
fn growth(iterations: &[(usize, usize)]) -> Option<f64> {
    let (coarse, fine) = (iterations.first()?, iterations.last()?);
    (fine.0 > coarse.0).then(|| (fine.1 as f64 / coarse.1 as f64).ln() / (fine.0 as f64 / coarse.0 as f64).ln())
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
    let stokes = Stokes::new(session, &grid);
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
    let plain = match plain_iterations(&stokes, &rhs) {
        Ok(iterations) => Some(iterations),
        Err(Error::Diverged(_)) => None,
        Err(error) => return Err(error),
    };
    Ok(Row { hypre, setup, plain })
}

/// The symmetric form of the fluid's equations, in `(u, h p)` with rows `h^2` (momentum) and `-h` (continuity).
///
/// Its eigenvalues reach from `-1` to `-h` and from `h^2` (slow solenoidal flows) to 1, so the iterations of MINRES grow
/// like `h^-1` to `h^-3/2`: the scalar Laplacian's `1/h`, and the price of the constraint.
struct Symmetric<'a, const D: usize> {
    stokes: &'a Stokes<D>,
    unscaled: Vector,
}

impl<const D: usize> System for Symmetric<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.unscaled.copy_from(input)?;
        let fields = self.stokes.balanced_fields();
        let (range, h) = &fields[D];
        self.unscaled.local_mut()?[range.clone()].iter_mut().for_each(|pressure| *pressure /= h);
        self.stokes.multiply(&self.unscaled, output)?;
        self.stokes.balance(output)?;
        negate(range, output)
    }
}

fn negate(range: &Range<usize>, vector: &mut Vector) -> Result<()> {
    vector.local_mut()?[range.clone()].iter_mut().for_each(|value| *value = -*value);
    Ok(())
}

fn plain_iterations<const D: usize>(stokes: &Stokes<D>, rhs: &Vector) -> Result<usize> {
    let settings = KrylovSettings { method: KrylovMethod::MinimalResidual, tolerance: TOLERANCE, most_iterations: MOST_ITERATIONS };
    let mut krylov = Krylov::new(stokes.session(), rhs.local()?.len(), c"plain_", settings)?;
    let mut system = Symmetric { stokes, unscaled: stokes.vector()? };
    let (mut symmetric_rhs, mut x) = (rhs.like()?, rhs.like()?);
    symmetric_rhs.copy_from(rhs)?;
    negate(&stokes.balanced_fields()[D].0, &mut symmetric_rhs)?;
    Ok(krylov.solve(&mut system, (&symmetric_rhs, &mut x), &mut |_, _| {})?.iterations)
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
