//! The fluid without bodies: iterations with hypre, which stay, and with no preconditioner, which grow at least like `1/h`.

use std::{ops::Range, time::Instant};

use nalgebra::SVector;
use serde::Serialize;

use super::grids::grids;
use crate::{
    error::{Error, Result},
    flow::{FluidSystem, InverseMethod, Stokes},
    geometry::{Axis, Domain},
    grid::Grid,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Session, System, Vector},
};

/// Relative residual wanted.
const TOLERANCE: f64 = 1e-8;

/// Iterations after which a solver without preconditioner is given up.
pub const MOST_ITERATIONS: usize = 5000;

/// Coarsest and finest grids in 2D and 3D: finer ones take a solver without preconditioner too long.
const GRIDS: [[usize; 2]; 2] = [[32, 128], [16, 32]];

/// The fluid of one box on one grid.
#[derive(Debug, Clone, Serialize)]
pub struct Fluid {
    /// Dimension of the box.
    pub dimension: usize,
    /// What bounds it.
    pub name: &'static str,
    /// Cells per side.
    pub cells: usize,
    /// Iterations of GMRES with hypre in projection form.
    pub hypre: usize,
    /// Seconds to set hypre up.
    pub setup_seconds: f64,
    /// Seconds of these iterations.
    pub solve_seconds: f64,
    /// Iterations of MINRES with no preconditioner; nothing if they are more than 5000.
    pub plain: Option<usize>,
}

/// All boxes on all grids, none finer than the finest that is asked for in 2D and 3D.
///
/// # Errors
/// The rank count does not fit, or hypre does not converge.
pub fn fluid(session: &Session, finest: [usize; 2]) -> Result<Vec<Fluid>> {
    let listed = |place: usize| {
        let [coarsest, own] = GRIDS[place];
        grids(coarsest, own).filter(move |&cells| cells <= finest[place])
    };
    let mut rows = Vec::new();
    for walls in 0..=2 {
        for cells in listed(0) {
            rows.push(row::<2>(session, walls, cells)?);
        }
    }
    for walls in 0..=1 {
        for cells in listed(1) {
            rows.push(row::<3>(session, walls, cells)?);
        }
    }
    Ok(rows)
}

fn row<const D: usize>(session: &Session, walls: usize, cells: usize) -> Result<Fluid> {
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let axes = std::array::from_fn(|axis| if axis >= D - walls { still } else { Axis::Periodic });
    let domain = Domain::<D> { size: SVector::repeat(1.0), axes };
    let grid = Grid::new(&domain, 1.0 / cells as f64, session.world().size(), session.world().rank())?;
    let stokes = Stokes::new(session, &grid);
    let start = Instant::now();
    let mut inverse = InverseMethod::Hypre.set_up(&stokes, &grid)?;
    let setup_seconds = start.elapsed().as_secs_f64();
    let rhs = right_hand_side(&stokes, &grid)?;
    let mut x = stokes.vector()?;
    let hypre = FluidSystem { stokes: &stokes, inverse: Some(inverse.as_mut()) }.solve(&rhs, &mut x, TOLERANCE, MOST_ITERATIONS)?;
    let plain = match plain_iterations(&stokes, &rhs) {
        Ok(iterations) => Some(iterations),
        Err(Error::Diverged(_)) => None,
        Err(error) => return Err(error),
    };
    let name = ["periodic", "channel", "closed"][walls];
    Ok(Fluid { dimension: D, name, cells, hypre: hypre.iterations, setup_seconds, solve_seconds: hypre.seconds, plain })
}

fn right_hand_side<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>) -> Result<Vector> {
    let mut rhs = stokes.vector()?;
    for field in 0..=D {
        let mut local = rhs.local_mut()?;
        for (value, index) in local[grid.local_range(field)].iter_mut().zip(grid.block(field).indices()) {
            *value = forcing(field, &grid.position(field, index.map(|index| index as isize)));
        }
    }
    stokes.balance(&mut rhs)?;
    Ok(rhs)
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
    Ok(krylov.solve(&mut system, &symmetric_rhs, &mut x, &mut |_, _| {})?.iterations)
}

/// Smooth waves and a step: energy at all scales.
fn forcing<const D: usize>(field: usize, point: &SVector<f64, D>) -> f64 {
    let step = if (point[0] - 0.3).abs() < 0.1 { 1.0 } else { 0.0 };
    (field + 1) as f64 * (7.0 * point[0] + 3.0 * point[D - 1]).sin() + step
}
