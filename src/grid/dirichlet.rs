//! The Laplacian of a scalar at cell centres that is zero on walls, which lie half a cell beyond the last centres.
//!
//! The value beyond a wall is the reflected one, so that the wall enters with weight `2/h^2`. What this misses is known: on a wall
//! `u_nn = -f`, and `u(-h/2) = -u(h/2) + h^2/4 u_nn` takes a quarter off the source `f` of the cells beside it.

use super::{
    operators::signed,
    staggered::{Grid, Index, Node},
    stencil::moved,
};
use crate::{
    error::Result,
    petsc::{Matrix, RowBuilder, Session},
};

/// Whether an index is that of a cell; along a walled axis the indices next to the cells stand for the walls.
pub fn within<const D: usize>(grid: &Grid<D>, index: Index<D>) -> bool {
    (0..D).all(|axis| grid.domain().periodic(axis) || (0..grid.cells()[axis] as isize).contains(&index[axis]))
}

/// Coordinate of an index along an axis: of a cell's centre, or of the wall that it stands for.
pub fn coordinate<const D: usize>(grid: &Grid<D>, axis: usize, index: isize) -> f64 {
    let centre = (index as f64 + 0.5) * grid.spacing()[axis];
    if grid.domain().periodic(axis) { centre } else { centre.clamp(0.0, grid.domain().size[axis]) }
}

/// Visits neighbours of a cell, or points of walls, with their weights in the Laplacian; the centre weighs minus the sum of the weights.
pub fn laplacian<const D: usize>(grid: &Grid<D>, index: Index<D>, mut visit: impl FnMut(Index<D>, f64)) {
    for axis in 0..D {
        let weight = grid.spacing()[axis].powi(-2);
        for side in [-1, 1] {
            let neighbour = moved(index, axis, side);
            visit(neighbour, if within(grid, neighbour) { weight } else { 2.0 * weight });
        }
    }
}

/// Takes from a uniform source in `rows` (this rank's) what reflected values at walls miss.
pub fn bend_at_walls<const D: usize>(grid: &Grid<D>, source: f64, rows: &mut [f64]) {
    for (row, index) in rows.iter_mut().zip(grid.block(D).indices()) {
        laplacian(grid, signed(index), |neighbour, _| {
            if !within(grid, neighbour) {
                *row -= 0.25 * source;
            }
        });
    }
}

/// Minus the Laplacian (zero on walls; symmetric, positive definite if there are any).
pub fn minus_laplacian<const D: usize>(session: &Session, grid: &Grid<D>) -> Result<Matrix> {
    let mut rows = RowBuilder::default();
    let push = |index: Index<D>, weight: f64, rows: &mut RowBuilder| {
        if within(grid, index)
            && let Node::Unknown(column) = grid.node(D, index)
        {
            rows.push(column, weight);
        }
    };
    for index in grid.block(D).indices() {
        let index = signed(index);
        let mut centre = 0.0;
        laplacian(grid, index, |neighbour, weight| {
            centre += weight;
            push(neighbour, -weight, &mut rows);
        });
        push(index, centre, &mut rows);
        rows.end_row();
    }
    Matrix::from_rows(session, grid.local_unknowns(D), rows)
}
