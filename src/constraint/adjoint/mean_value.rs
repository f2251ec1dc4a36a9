//! The `mean-value` method: multipliers on the surface, the velocity there interpolated linearly from the grid.
//!
//! The velocity on `gamma` has to be its own mean, in the sense of rigid motions: `u = m(u)`, tested with the surface modes.
//! Stencils are not corrected for the jumps that the multipliers cause, which costs an order of accuracy.

use super::{AdjointBody, equations::Equations, nodes::Collector};
use crate::{
    constraint::sharp::Placed,
    geometry::Axis,
    grid::{
        Grid, Index,
        interpolation::{Pair, linear},
    },
    linalg::SparseRows,
};

/// The blocks of one body.
pub fn assemble<const D: usize>(grid: &Grid<D>, (body, placed): (usize, &Placed<D>)) -> AdjointBody<D> {
    let mut collector = Collector::new(grid, placed.center);
    let (mut rows, mut wall_values) = (SparseRows::default(), Vec::new());
    for offset in placed.surface.offsets() {
        let point = placed.center + offset;
        for component in 0..D {
            let pairs: [Pair; D] = std::array::from_fn(|axis| linear(grid, component, axis, point[axis]));
            let (mut terms, mut wall) = (Vec::new(), 0.0);
            for corner in 0..1 << D {
                let side = |axis: usize| (corner >> axis) & 1;
                let weight = (0..D).map(|axis| pairs[axis].weights[side(axis)]).product::<f64>();
                match wall_velocity(grid, component, &pairs, side) {
                    Some(velocity) => wall += weight * velocity,
                    None => {
                        let index: Index<D> = std::array::from_fn(|axis| pairs[axis].first + side(axis) as isize);
                        terms.extend(collector.node(component, index).map(|node| (node, weight)));
                    }
                }
            }
            rows.push(terms);
            wall_values.push(wall);
        }
    }
    if wall_values.iter().all(|value| *value == 0.0) {
        wall_values.clear();
    }
    let cell = grid.spacing().product();
    let equations = Equations::Surface { surface: placed.surface.clone(), strength: placed.surface.area() / cell };
    AdjointBody { body, center: placed.center, nodes: collector.nodes, rows, wall_values, equations, cell }
}

/// The velocity of the wall that a corner of the interpolation lies on, if that is between lattice points.
fn wall_velocity<const D: usize>(grid: &Grid<D>, component: usize, pairs: &[Pair; D], side: impl Fn(usize) -> usize) -> Option<f64> {
    (0..D).find_map(|axis| match grid.domain().axes[axis] {
        Axis::Walls { lower, .. } if pairs[axis].wall == Some((side(axis), false)) => Some(lower[component]),
        Axis::Walls { upper, .. } if pairs[axis].wall == Some((side(axis), true)) => Some(upper[component]),
        _ => None,
    })
}
