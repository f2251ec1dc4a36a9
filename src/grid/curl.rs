//! The curl of the velocity at the corners of the cells, in 3D at their edges: centred differences of the staggered velocities.
//!
//! The component in the plane of the axes `(row, column)` is `d u_row / d x_column - d u_column / d x_row`. It stands where the lower sides of a cell
//! along both axes meet, in 3D halfway along the third one. On walls the differences are those of parabolas through the wall and two nodes.

use nalgebra::SVector;

use super::{
    staggered::{Grid, Index},
    stencil::{Site, Term, moved, oblique_difference, wall_between},
};

/// Weights in the slope at a wall of the value there and of those at the nodes half a cell and one and a half away, over the spacing.
const AT_WALL: [f64; 3] = [-8.0 / 3.0, 3.0, -1.0 / 3.0];

/// Visits the terms of the curl in a plane at the corner of a cell; along walled axes of the plane indices up to the number of cells have one.
pub fn curl<const D: usize>(grid: &Grid<D>, (row, column): (usize, usize), index: Index<D>, mut visit: impl FnMut(Term<D>)) {
    slope(grid, row, column, index, &mut visit);
    slope(grid, column, row, index, |term| visit(Term { weight: -term.weight, ..term }));
}

/// Visits the terms of the curl in a plane at a point (not wrapped; between the walls): linear between the corners.
pub fn curl_at<const D: usize>(grid: &Grid<D>, plane: (usize, usize), point: &SVector<f64, D>, mut visit: impl FnMut(Term<D>)) {
    let point = grid.straightened(*point);
    let lines: [(isize, f64); D] = std::array::from_fn(|axis| {
        let on_corners = axis == plane.0 || axis == plane.1;
        let place = point[axis] / grid.spacing()[axis] - if on_corners { 0.0 } else { 0.5 };
        let last = grid.cells()[axis] as isize - if on_corners { 1 } else { 2 };
        let first = if grid.domain().periodic(axis) { place.floor() as isize } else { (place.floor() as isize).clamp(0, last) };
        (first, place - first as f64)
    });
    for choice in 0..1 << D {
        let upper = |axis: usize| choice >> axis & 1 == 1;
        let part: f64 = (0..D).map(|axis| if upper(axis) { lines[axis].1 } else { 1.0 - lines[axis].1 }).product();
        let index = std::array::from_fn(|axis| lines[axis].0 + isize::from(upper(axis)));
        curl(grid, plane, index, |term| visit(Term { weight: part * term.weight, ..term }));
    }
}

/// Visits the terms of the slope of a velocity component along another axis, halfway between an index and the one before it.
fn slope<const D: usize>(grid: &Grid<D>, field: usize, axis: usize, index: Index<D>, mut visit: impl FnMut(Term<D>)) {
    let weight = 1.0 / grid.spacing()[axis];
    let before = moved(index, axis, -1);
    let lattice = |index: Index<D>, weight: f64| Term { site: Site::Lattice { field, index }, weight };
    let lower = wall_between(grid, field, axis, before).map(|wall| (wall, before, 1));
    let wall = lower.or_else(|| wall_between(grid, field, axis, index).map(|wall| (wall, index, -1)));
    let Some(((plane, velocity), beyond, inward)) = wall else {
        visit(lattice(index, weight));
        visit(lattice(before, -weight));
        return oblique_difference(grid, field, axis, before, index).for_each(visit);
    };
    let weights = AT_WALL.map(|part| part * weight * inward as f64);
    let mut position = grid.position(field, index);
    position[axis] = plane;
    visit(Term { site: Site::Wall { field, position, index: beyond, value: velocity[field] }, weight: weights[0] });
    (1..3).for_each(|steps| visit(lattice(moved(beyond, axis, inward * steps), weights[steps as usize])));
}
