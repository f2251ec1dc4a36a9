//! The vorticity: the curl of the velocity, of the whole flow with its background.

use nalgebra::SVector;

use super::{
    cells::{beside, weights},
    faces::NearFaces,
    sample::vorticities,
};
use crate::{
    body::planes,
    error::Result,
    flow::Drive,
    grid::{Grid, Index, curl::curl, operators::signed, stencil::moved},
    petsc::Vector,
};

/// Layers of cells around those of a rank on which their vorticity depends on oblique grids: two beside a cell, the far corner of those, and one more along x.
const LAYERS_OF_OBLIQUE_GRIDS: usize = 4;

/// Brings the velocities on which the vorticity of this rank's cells depends to this rank; made once for a grid.
pub struct CellVorticity<const D: usize> {
    faces: NearFaces<D>,
}

impl<const D: usize> CellVorticity<D> {
    /// Plans the exchange of faces between ranks; `fluid` is any fluid vector.
    ///
    /// # Errors
    /// PETSc fails, here and below.
    pub fn new(grid: &Grid<D>, fluid: &Vector) -> Result<CellVorticity<D>> {
        let layers = if grid.slope() == 0.0 { 1 } else { LAYERS_OF_OBLIQUE_GRIDS };
        Ok(CellVorticity { faces: NearFaces::new(grid, fluid, layers)? })
    }

    /// The vorticity of a fluid vector and the background of a drive at the centres of this rank's cells, in the order of its block: one number each
    /// in 2D, the components along the axes in 3D. Those at a centre are the means of those at the corners, or edges, around it. Collective.
    pub fn evaluate(&mut self, grid: &Grid<D>, fluid: &Vector, drive: &Drive<D>) -> Result<Vec<f64>> {
        let faces = self.faces.of(grid, fluid)?;
        let mean = |cell: Index<D>, (row, column): (usize, usize)| {
            let mut sum = 0.0;
            for (along_row, along_column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let corner = moved(moved(cell, row, along_row), column, along_column);
                curl(grid, (row, column), corner, |term| sum += 0.25 * faces.value(&term));
            }
            sum
        };
        let beside = beside(grid);
        let cells = grid.block(D).indices().map(signed).zip(weights(grid));
        Ok(cells
            .flat_map(|(cell, weights)| planes::<D>().iter().map(move |&plane| (cell, weights, plane)))
            .map(|(cell, weights, plane)| {
                let of_cells = beside.iter().zip(weights).map(|(&along_x, weight)| weight * mean(moved(cell, 0, along_x), plane));
                of_cells.sum::<f64>() + of_background(drive, plane)
            })
            .collect())
    }
}

/// The vorticity in a plane of a fluid vector and the background of a drive at points of the box, on every rank; linear between corners. Collective.
///
/// # Errors
/// PETSc fails.
pub fn vorticity_at<const D: usize>(
    grid: &Grid<D>,
    fluid: &Vector,
    drive: &Drive<D>,
    points: &[SVector<f64, D>],
    plane: (usize, usize),
) -> Result<Vec<f64>> {
    let background = of_background(drive, plane);
    Ok(vorticities(grid, fluid, points, plane)?.into_iter().map(|disturbance| disturbance + background).collect())
}

/// The vorticity of the background, whose velocity is linear in the place.
fn of_background<const D: usize>(drive: &Drive<D>, (row, column): (usize, usize)) -> f64 {
    drive.slope(row, column) - drive.slope(column, row)
}
