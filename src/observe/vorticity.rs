//! The vorticity: the curl of the velocity, of the whole flow with its background.

use nalgebra::SVector;

use super::sample::vorticities;
use crate::{
    body::planes,
    error::Result,
    flow::{Drive, OpenEnds},
    grid::{
        Grid, Index, Node,
        curl::curl,
        operators::signed,
        stencil::{Site, Term, moved},
    },
    petsc::{Scatter, Vector},
};

/// Brings the velocities on which the vorticity of this rank's cells depends to this rank; made once for a grid.
pub struct CellVorticity<const D: usize> {
    faces: Scatter,
    /// First index and number of indices along each axis of the cells whose lower faces are known: those of this rank and a layer around them.
    start: Index<D>,
    extent: [usize; D],
    /// For each of them and each component the place of the lower face among those that are fetched; none where the velocity is zero, on walls.
    places: Vec<Option<usize>>,
}

impl<const D: usize> CellVorticity<D> {
    /// Plans the exchange of faces between ranks; `fluid` is any fluid vector.
    ///
    /// # Errors
    /// PETSc fails, here and below.
    pub fn new(grid: &Grid<D>, fluid: &Vector) -> Result<CellVorticity<D>> {
        let block = grid.block(D);
        let start: Index<D> = block.start.map(|first| first as isize - 1);
        let extent = std::array::from_fn(|axis| block.end[axis] - block.start[axis] + 2);
        let (mut wanted, mut places) = (Vec::new(), Vec::new());
        for place in 0..extent.iter().product() {
            let index = index_at(start, extent, place);
            for component in 0..D {
                places.push(unknown(grid, component, index).map(|unknown| {
                    wanted.push(unknown);
                    wanted.len() - 1
                }));
            }
        }
        Ok(CellVorticity { faces: Scatter::new(fluid, &wanted)?, start, extent, places })
    }

    /// The vorticity of a fluid vector and the background of a drive at the centres of this rank's cells, in the order of its block: one number each
    /// in 2D, the components along the axes in 3D. Those at a centre are the means of those at the corners, or edges, around it. Collective.
    pub fn evaluate(&mut self, grid: &Grid<D>, fluid: &Vector, drive: &Drive<D>) -> Result<Vec<f64>> {
        let CellVorticity { faces, start, extent, places } = self;
        let faces = faces.fetch(fluid)?;
        let ends = OpenEnds::of(grid, fluid)?;
        let value = |term: Term<D>| {
            term.weight
                * match (ends.as_ref().and_then(|ends| ends.at_site(grid, &term.site)), term.site) {
                    (Some(value), _) | (None, Site::Wall { value, .. }) => value,
                    (None, Site::Lattice { field, index }) => {
                        places[D * place_of(*start, *extent, index) + field].map_or(0.0, |place| faces[place])
                    }
                }
        };
        let mean = |cell: Index<D>, (row, column): (usize, usize)| {
            let mut sum = 0.0;
            for (along_row, along_column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let corner = moved(moved(cell, row, along_row), column, along_column);
                curl(grid, (row, column), corner, |term| sum += 0.25 * value(term));
            }
            sum
        };
        let cells = grid.block(D).indices().map(signed);
        Ok(cells
            .flat_map(|cell| planes::<D>().iter().map(move |&plane| (cell, plane)))
            .map(|(cell, plane)| mean(cell, plane) + of_background(drive, plane))
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
    let at = |axis: usize| drive.background(&SVector::from_fn(|other, _| if other == axis { 1.0 } else { 0.0 }));
    at(column)[row] - at(row)[column]
}

/// The unknown at the lower face of a cell that may be a layer outside of the box.
fn unknown<const D: usize>(grid: &Grid<D>, component: usize, index: Index<D>) -> Option<usize> {
    let within = |axis: usize| grid.domain().periodic(axis) || (0..grid.cells()[axis] as isize).contains(&index[axis]);
    match (0..D).all(within).then(|| grid.fluid_node(component, index)) {
        Some(Node::Unknown(unknown)) => Some(unknown),
        _ => None,
    }
}

fn index_at<const D: usize>(start: Index<D>, extent: [usize; D], place: usize) -> Index<D> {
    let (mut index, mut rest) = (start, place);
    for axis in 0..D {
        index[axis] += (rest % extent[axis]) as isize;
        rest /= extent[axis];
    }
    index
}

fn place_of<const D: usize>(start: Index<D>, extent: [usize; D], index: Index<D>) -> usize {
    (0..D).rev().fold(0, |place, axis| place * extent[axis] + (index[axis] - start[axis]) as usize)
}
