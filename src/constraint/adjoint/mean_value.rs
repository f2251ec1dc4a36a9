//! The `mean-value` method: multipliers on the surface, the velocity there interpolated linearly from the grid.
//!
//! The velocity on `gamma` has to be its own mean, in the sense of rigid motions: `u = m(u)`, tested with the surface modes.
//! Stencils are not corrected for the jumps that the multipliers cause, which costs an order of accuracy.

use super::{body::AdjointBody, inertia::AdjointMethod, nodes::Collector};
use crate::{
    constraint::{
        body::BodyBlocks,
        kept_values::Precision,
        method::{Method, Size},
        placed::{Placed, Surrounded},
        sharp,
        unknowns::Unknowns,
    },
    grid::{
        Grid, Index,
        interpolation::{Pair, linear},
    },
    linalg::SparseRows,
};

/// The method.
#[derive(Debug, Clone, Copy)]
pub struct MeanValue;

impl<const D: usize> Method<D, Box<dyn BodyBlocks<D>>> for MeanValue {
    fn description(&self) -> String {
        "surface multipliers with linear interpolation (mean-value)".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        bodies.iter().map(|body| Box::new(assemble(grid, body.placed)) as Box<_>).collect()
    }

    fn bytes(&self, grid: &Grid<D>, size: &Size<D>) -> f64 {
        sharp::bytes(grid, size, Precision::Double)
    }
}

impl<const D: usize> AdjointMethod<D> for MeanValue {
    fn body(&self, grid: &Grid<D>, placed: &Placed<D>) -> AdjointBody<D> {
        assemble(grid, placed)
    }
}

/// The blocks of one body, of a fluid or of a scalar.
pub fn assemble<const D: usize>(grid: &Grid<D>, placed: &Placed<D>) -> AdjointBody<D> {
    let unknowns = Unknowns::of(placed.surface.modes.as_ref());
    let mut collector = Collector::new(grid, unknowns, placed.center);
    let (mut rows, mut wall_values) = (SparseRows::default(), Vec::new());
    for offset in placed.surface.offsets() {
        let point = placed.center + offset;
        for component in 0..unknowns.components::<D>() {
            let lattice = unknowns.lattice::<D>(component);
            let pairs: [Pair; D] = std::array::from_fn(|axis| linear(grid, lattice, axis, point[axis]));
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
    AdjointBody::on_surface(grid, placed, collector.nodes, rows, wall_values)
}

/// The velocity of the wall that a corner of the interpolation lies on, if that is between lattice points.
fn wall_velocity<const D: usize>(grid: &Grid<D>, component: usize, pairs: &[Pair; D], side: impl Fn(usize) -> usize) -> Option<f64> {
    (0..D).find_map(|axis| {
        let (walls, (_, upper)) = (grid.domain().axes[axis].ends()?, pairs[axis].wall.filter(|(place, _)| *place == side(axis))?);
        Some(walls[usize::from(upper)][component])
    })
}
