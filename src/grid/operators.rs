//! The matrices of the box: assembled once, no body ever changes an entry.

use super::{
    staggered::{Grid, Index, Node},
    stencil::{self, Site, Term},
};
use crate::{
    error::Result,
    petsc::{Matrix, RowBuilder, Session},
};

/// Minus the Laplacian of a field (homogeneous wall values; symmetric, positive semi-definite).
pub fn minus_laplacian<const D: usize>(session: &Session, grid: &Grid<D>, field: usize) -> Result<Matrix> {
    shifted_laplacian(session, grid, field, 0.0)
}

/// A shift minus the Laplacian of a field.
pub fn shifted_laplacian<const D: usize>(session: &Session, grid: &Grid<D>, field: usize, shift: f64) -> Result<Matrix> {
    let mut rows = RowBuilder::default();
    for index in grid.block(field).indices() {
        let index = signed(index);
        let mut centre = shift;
        stencil::laplacian(grid, field, index, |term| {
            centre += term.weight;
            push(grid, &mut rows, Term { weight: -term.weight, ..term });
        });
        push(grid, &mut rows, Term { site: Site::Lattice { field, index }, weight: centre });
        rows.end_row();
    }
    Matrix::from_rows(session, grid.local_unknowns(field), rows)
}

/// The derivative of the pressure along `axis`, on the faces of that axis.
pub fn gradient<const D: usize>(session: &Session, grid: &Grid<D>, axis: usize) -> Result<Matrix> {
    let mut rows = RowBuilder::default();
    for index in grid.block(axis).indices() {
        stencil::gradient(grid, axis, signed(index)).for_each(|term| push(grid, &mut rows, term));
        rows.end_row();
    }
    Matrix::from_rows(session, grid.local_unknowns(D), rows)
}

/// The contribution of the velocity component along `axis` to the divergence, at cell centres.
pub fn divergence<const D: usize>(session: &Session, grid: &Grid<D>, axis: usize) -> Result<Matrix> {
    let mut rows = RowBuilder::default();
    for index in grid.block(D).indices() {
        stencil::divergence(grid, axis, signed(index)).for_each(|term| push(grid, &mut rows, term));
        rows.end_row();
    }
    Matrix::from_rows(session, grid.local_unknowns(axis), rows)
}

/// Adds to `values` (this rank's part of a field) the part of its Laplacian that comes from the velocities of the walls.
pub fn add_wall_laplacian<const D: usize>(grid: &Grid<D>, field: usize, values: &mut [f64]) {
    for (value, index) in values.iter_mut().zip(grid.block(field).indices()) {
        stencil::laplacian(grid, field, signed(index), |term| {
            if let Site::Wall { value: wall, .. } = term.site {
                *value += term.weight * wall;
            }
        });
    }
}

/// Adds to `values` (this rank's part of a velocity component) a uniform force along it, with the part that beside walls bends the flow as the
/// [gradient of the pressure](stencil::gradient) does.
pub fn add_uniform_force<const D: usize>(grid: &Grid<D>, axis: usize, force: f64, values: &mut [f64]) {
    for (value, index) in values.iter_mut().zip(grid.block(axis).indices()) {
        *value += force * stencil::left_beside_walls(grid, axis, signed(index));
    }
}

fn push<const D: usize>(grid: &Grid<D>, rows: &mut RowBuilder, term: Term<D>) {
    if let Site::Lattice { field, index } = term.site
        && let Node::Unknown(column) = grid.node(field, index)
    {
        rows.push(column, term.weight);
    }
}

/// The lattice index of an unknown as an index before wrapping.
pub fn signed<const D: usize>(index: [usize; D]) -> Index<D> {
    index.map(|index| index as isize)
}
