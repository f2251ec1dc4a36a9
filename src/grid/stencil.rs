//! Finite-difference stencils as lists of terms: the matrices sum them, the jump corrections read them.

use nalgebra::SVector;

use super::staggered::{Grid, Index};

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
        /// The field.
        field: usize,
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

/// What is left of the derivative of the pressure along a wall half a cell away: see [`gradient`].
pub const BESIDE_WALL: f64 = 0.75;

/// The 5- or 7-point Laplacian of a velocity component or of the pressure at `index`, without the centre's own term:
/// the centre weighs minus the sum of the weights.
///
/// A wall half a cell away enters a tangential component with weight `2/h^2` (the value beyond it is the reflected one);
/// the pressure has no flux through walls. On an oblique grid, whose lines along y have the slope `e`, it is `(1 + e^2) d_x^2 - 2 e d_x d_y + ..` along the lines.
pub fn laplacian<const D: usize>(grid: &Grid<D>, field: usize, index: Index<D>, mut visit: impl FnMut(Term<D>)) {
    let slope = grid.slope();
    for axis in 0..D {
        let weight = grid.spacing()[axis].powi(-2) * if axis == 0 { 1.0 + slope * slope } else { 1.0 };
        for side in [-1, 1] {
            let neighbour = moved(index, axis, side);
            match wall_between(grid, field, axis, neighbour) {
                None => visit(Term { site: Site::Lattice { field, index: neighbour }, weight }),
                Some(_) if field == D => {}
                Some((plane, velocity)) => {
                    let mut position = grid.position(field, index);
                    position[axis] = plane;
                    visit(Term { site: Site::Wall { field, position, index: neighbour, value: velocity[field] }, weight: 2.0 * weight });
                }
            }
        }
    }
    if slope != 0.0 {
        let weight = -0.5 * slope / (grid.spacing()[0] * grid.spacing()[1]);
        for (along_x, along_y) in [(-1, -1), (1, 1), (-1, 1), (1, -1)] {
            let corner = moved(moved(index, 0, along_x), 1, along_y);
            visit(Term { site: Site::Lattice { field, index: corner }, weight: weight * (along_x * along_y) as f64 });
        }
    }
}

/// The derivative along `axis` of the pressure at face `index` of that axis, less a quarter for each wall half a cell away.
///
/// On a wall `mu u_nn = p_t` for velocities along it. The value beyond it, `2 u_w - u_0 + h^2/4 u_nn`, is the reflected one, as
/// [`laplacian`] takes it, and what the flow bends, which is put here: so the Laplacian stays symmetric, and no part of the mean momentum is lost.
pub fn gradient<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>) -> impl Iterator<Item = Term<D>> + use<D> {
    let along = difference(grid, axis, index, left_beside_walls(grid, axis, index));
    along.into_iter().chain(oblique_difference(grid, D, axis, moved(index, axis, -1), index))
}

/// What is left at a face of `axis` of any uniform force or gradient of the pressure along it: [`BESIDE_WALL`] at one wall.
pub fn left_beside_walls<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>) -> f64 {
    let wall_towards = |across: usize, side: isize| wall_between(grid, axis, across, moved(index, across, side)).is_some();
    let walls = (0..D).map(|across| [-1, 1].map(|side| wall_towards(across, side)).into_iter().filter(|wall| *wall).count()).sum::<usize>();
    1.0 - (1.0 - BESIDE_WALL) * walls as f64
}

/// A part of the difference of the pressure along `axis` at a face of that axis.
fn difference<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>, part: f64) -> [Term<D>; 2] {
    let weight = part / grid.spacing()[axis];
    let term = |shift, weight| Term { site: Site::Lattice { field: D, index: moved(index, axis, shift) }, weight };
    [term(-1, -weight), term(0, weight)]
}

/// One of the walls across an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WallSide {
    /// The axis.
    pub axis: usize,
    /// The step along it away from the wall.
    pub inward: isize,
}

/// The wall on which an index of a velocity component lies, or for which it stands.
///
/// None in the fluid, and none where walls meet: nothing passes there.
pub fn wall_at<const D: usize>(grid: &Grid<D>, field: usize, index: Index<D>) -> Option<WallSide> {
    let on = |axis: usize| {
        let beyond = isize::from(field != axis);
        match index[axis] {
            _ if grid.domain().periodic(axis) => None,
            lower if lower == -beyond => Some(WallSide { axis, inward: 1 }),
            upper if upper == grid.cells()[axis] as isize => Some(WallSide { axis, inward: -1 }),
            _ => None,
        }
    };
    let mut walls = (0..D).filter_map(on);
    walls.next().filter(|_| walls.next().is_none())
}

/// What the momentum rows beside a wall lose to it at one of its points, as if that had a row: the terms of the
/// [`laplacian`] and of the [`gradient`] that cancel those of its neighbours.
pub fn wall_row<const D: usize>(
    grid: &Grid<D>,
    field: usize,
    index: Index<D>,
    WallSide { axis, inward }: WallSide,
    mut velocity: impl FnMut(Term<D>),
    mut pressure: impl FnMut(Term<D>),
) {
    let weight = grid.spacing()[axis].powi(-2) * if field == axis { 1.0 } else { 2.0 };
    let first = moved(index, axis, inward);
    velocity(Term { site: Site::Lattice { field, index: first }, weight });
    if field == axis {
        let cell = if inward > 0 { index } else { first };
        pressure(Term { site: Site::Lattice { field: D, index: cell }, weight: inward as f64 / grid.spacing()[axis] });
        return;
    }
    difference(grid, field, first, 1.0 - BESIDE_WALL).into_iter().for_each(pressure);
}

/// The derivative along `axis` of the velocity component along it at the centre of cell `index`.
pub fn divergence<const D: usize>(grid: &Grid<D>, axis: usize, index: Index<D>) -> impl Iterator<Item = Term<D>> + use<D> {
    let weight = 1.0 / grid.spacing()[axis];
    let (lower, upper) = (index, moved(index, axis, 1));
    let term = |index, weight| Term { site: Site::Lattice { field: axis, index }, weight };
    [term(lower, -weight), term(upper, weight)].into_iter().chain(oblique_difference(grid, axis, axis, lower, upper))
}

/// What a difference along `axis`, between two neighbours of a field, lacks of a derivative along that axis on oblique grids: along y, minus the slope
/// times the mean of the derivatives along x at both.
pub(super) fn oblique_difference<const D: usize>(
    grid: &Grid<D>,
    field: usize,
    axis: usize,
    lower: Index<D>,
    upper: Index<D>,
) -> impl Iterator<Item = Term<D>> + use<D> {
    let weight = 0.25 * grid.slope() / grid.spacing()[0];
    let oblique = axis == 1 && weight != 0.0;
    let sides = [(lower, -1, weight), (lower, 1, -weight), (upper, -1, weight), (upper, 1, -weight)];
    let term = move |(index, along_x, weight)| Term { site: Site::Lattice { field, index: moved(index, 0, along_x) }, weight };
    sides.into_iter().filter(move |_| oblique).map(term)
}

/// The index `steps` further along `axis`.
pub fn moved<const D: usize>(mut index: Index<D>, axis: usize, steps: isize) -> Index<D> {
    index[axis] += steps;
    index
}

/// The wall between the lattice and a neighbour that would lie beyond it: its coordinate and velocity.
pub(super) fn wall_between<const D: usize>(
    grid: &Grid<D>,
    field: usize,
    axis: usize,
    neighbour: Index<D>,
) -> Option<(f64, SVector<f64, D>)> {
    let [lower, upper] = grid.domain().axes[axis].ends()?;
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
