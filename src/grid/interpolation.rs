//! Interpolation of a velocity component at a point: cubic (4-point Lagrange, one-sided next to walls) and linear.

use nalgebra::SVector;

use super::{
    staggered::{Grid, Index},
    stencil::{Site, Term},
};
use crate::linalg::lagrange;

/// Nodes per axis.
pub const NODES: usize = 4;

/// The four nodes used along one axis.
pub struct Line {
    /// Lattice indices, one after the other; beyond the lattice, the index stands for the wall there.
    pub index: [isize; NODES],
    /// Coordinates.
    coordinate: [f64; NODES],
    /// Weights.
    pub weight: [f64; NODES],
    /// How far the point lies after the second node, in spacings.
    pub part: f64,
    /// The node, if any, that lies on a wall between lattice points, and whether that is the upper one.
    pub wall: Option<(usize, bool)>,
}

/// Visits the `4^D` terms that interpolate component `component` at `point` (not wrapped; between the walls).
pub fn velocity<const D: usize>(grid: &Grid<D>, component: usize, point: &SVector<f64, D>, mut visit: impl FnMut(Term<D>)) {
    let point = grid.straightened(*point);
    let lines: [Line; D] = std::array::from_fn(|axis| line(grid, component, axis, point[axis]));
    for combination in 0..NODES.pow(D as u32) {
        let choice: [usize; D] = std::array::from_fn(|axis| (combination >> (2 * axis)) % NODES);
        let weight = (0..D).map(|axis| lines[axis].weight[choice[axis]]).product();
        visit(Term { site: site(grid, component, &lines, choice), weight });
    }
}

/// Visits the nodes and weights that interpolate a scalar, held at cell centres and zero on walls, at `point` (not wrapped).
pub fn scalar<const D: usize>(grid: &Grid<D>, point: &SVector<f64, D>, mut visit: impl FnMut(Index<D>, f64)) {
    let point = grid.straightened(*point);
    let lines: [Line; D] = std::array::from_fn(|axis| line(grid, D, axis, point[axis]));
    for combination in 0..NODES.pow(D as u32) {
        let choice: [usize; D] = std::array::from_fn(|axis| (combination >> (2 * axis)) % NODES);
        let on_wall = (0..D).any(|axis| lines[axis].wall.is_some_and(|(node, _)| node == choice[axis]));
        if !on_wall {
            let index = std::array::from_fn(|axis| lines[axis].index[choice[axis]]);
            visit(index, (0..D).map(|axis| lines[axis].weight[choice[axis]]).product());
        }
    }
}

#[inline]
fn site<const D: usize>(grid: &Grid<D>, field: usize, lines: &[Line; D], choice: [usize; D]) -> Site<D> {
    let index: Index<D> = std::array::from_fn(|axis| lines[axis].index[choice[axis]]);
    for axis in 0..D {
        if let (Some((node, upper_wall)), Some([lower, upper])) = (lines[axis].wall, grid.domain().axes[axis].ends())
            && node == choice[axis]
        {
            let position = SVector::from_fn(|axis, _| lines[axis].coordinate[choice[axis]]);
            return Site::Wall { field, position, index, value: if upper_wall { upper[field] } else { lower[field] } };
        }
    }
    Site::Lattice { field, index }
}

/// The nodes along an axis for a point at `x` there, [straightened](Grid::straightened), on the lattice of a field.
pub fn line<const D: usize>(grid: &Grid<D>, field: usize, axis: usize, x: f64) -> Line {
    let (h, cells, stagger) = (grid.spacing()[axis], grid.cells()[axis] as isize, grid.stagger(field, axis));
    let mut first = (x / h - stagger).floor() as isize - 1;
    let walled = !grid.domain().periodic(axis);
    // on a walled axis the nodes are faces 0..=n (normal) or wall, centres 0..n, wall (tangential: indices -1 and n stand for the walls)
    let lowest = if stagger == 0.0 { 0 } else { -1 };
    if walled {
        first = first.clamp(lowest, cells + 1 - NODES as isize);
    }
    let index = std::array::from_fn(|node| first + node as isize);
    let mut coordinate = index.map(|index| (index as f64 + stagger) * h);
    let wall = (walled && stagger > 0.0).then(|| index.iter().position(|&index| index == -1 || index == cells)).flatten();
    let wall = wall.map(|node| (node, index[node] == cells));
    if let Some((node, upper)) = wall {
        coordinate[node] = if upper { cells as f64 * h } else { 0.0 };
    }
    Line { index, coordinate, weight: lagrange(&coordinate, x), part: (x - coordinate[1]) / h, wall }
}

/// Two neighbouring nodes along one axis, between which a point lies.
pub struct Pair {
    /// Lattice index of the first; where [`wall`](Self::wall) says so, one of the two stands for a wall.
    pub first: isize,
    /// Weights of both.
    pub weights: [f64; 2],
    /// Which of them, if any, lies on a wall between lattice points, and whether that is the upper one.
    pub wall: Option<(usize, bool)>,
}

/// The nodes of linear interpolation along an axis for a point at `x` there, on the lattice of a field.
pub fn linear<const D: usize>(grid: &Grid<D>, field: usize, axis: usize, x: f64) -> Pair {
    let (h, cells, stagger) = (grid.spacing()[axis], grid.cells()[axis] as isize, grid.stagger(field, axis));
    let first = (x / h - stagger).floor() as isize;
    let mut ends = [first, first + 1].map(|index| (index as f64 + stagger) * h);
    let walled = stagger > 0.0 && !grid.domain().periodic(axis);
    let wall = if walled && first < 0 {
        ends[0] = 0.0;
        Some((0, false))
    } else if walled && first + 1 >= cells {
        ends[1] = cells as f64 * h;
        Some((1, true))
    } else {
        None
    };
    let part = (x - ends[0]) / (ends[1] - ends[0]);
    Pair { first, weights: [1.0 - part, part], wall }
}
