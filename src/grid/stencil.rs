//! Finite-difference stencils as lists of terms: the matrices sum them, the jump corrections read them.

use nalgebra::SVector;

use super::staggered::{Grid, Index};
use crate::geometry::Axis;

/// Where the value of a term is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Site<const D: usize> {
    /// On the lattice of a field (an unknown, or a wall on which the lattice lies).
    Lattice {
        /// The field.
        field: usize,
        /// The index, not wrapped.
        index: Index<D>,
    },
    /// On a wall between lattice points.
    Wall {
        /// The point.
        position: SVector<f64, D>,
        /// The index, beyond the lattice, that stands for it.
        index: Index<D>,
        /// The known value.
        value: f64,
    },
}

/// `weight` times the value at `site`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term<const D: usize> {
    /// Where.
    pub site: Site<D>,
    /// How much.
    pub weight: f64,
}

/// The 5- or 7-point Laplacian of a velocity component or of the pressure at `index`, without the centre's own term:
/// the centre weighs minus the sum of the weights.
///
/// A wall half a cell away enters a tangential component with weight `2/h^2` (the value beyond it is the reflected one);
/// the pressure has no flux through walls.
pub fn laplacian<const D: usize>(grid: &Grid<D>, field: usize, index: Index<D>, mut visit: impl FnMut(Term<D>)) {
    for axis in 0..D {
        let weight = grid.spacing()[axis].powi(-2);
        for side in [-1, 1] {
            let neighbour = moved(index, axis, side);
            match wall_between(grid, field, axis, neighbour) {
                None => visit(Term { site: Site::Lattice { field, index: neighbour }, weight }),
                Some(_) if field == D => {}
                Some((plane, velocity)) => {
                    let mut position = grid.position(field, index);
                    position[axis] = plane;
                    visit(Term { site: Site::Wall { position, index: neighbour, value: velocity[field] }, weight: 2.0 * weight });
                }
            }
        }
    }
}

/// The derivative along `axis` of the pressure at face `index` of that axis.
pub fn gradient<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>) -> [Term<D>; 2] {
    let weight = 1.0 / grid.spacing()[axis];
    let term = |shift, weight| Term { site: Site::Lattice { field: D, index: moved(index, axis, shift) }, weight };
    [term(-1, -weight), term(0, weight)]
}

/// The derivative along `axis` of the velocity component along it at the centre of cell `index`.
pub fn divergence<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>) -> [Term<D>; 2] {
    let weight = 1.0 / grid.spacing()[axis];
    let term = |shift, weight| Term { site: Site::Lattice { field: axis, index: moved(index, axis, shift) }, weight };
    [term(0, -weight), term(1, weight)]
}

/// The index `steps` further along `axis`.
pub fn moved<const D: usize>(mut index: Index<D>, axis: usize, steps: isize) -> Index<D> {
    index[axis] += steps;
    index
}

/// The wall between the lattice and a neighbour that would lie beyond it: its coordinate and velocity.
fn wall_between<const D: usize>(grid: &Grid<D>, field: usize, axis: usize, neighbour: Index<D>) -> Option<(f64, SVector<f64, D>)> {
    let Axis::Walls { lower, upper } = grid.domain().axes[axis] else { return None };
    let cells = grid.cells()[axis] as isize;
    if field == axis {
        return None;
    }
    match neighbour[axis] {
        -1 => Some((0.0, lower)),
        beyond if beyond == cells => Some((grid.domain().size[axis], upper)),
        _ => None,
    }
}
