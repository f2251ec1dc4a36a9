//! The `distributed` method: the velocity is rigid at every lattice point inside a body.
//!
//! It is enough to say so on the outermost layer, the points inside with a neighbour outside: between rigid values on the
//! layer the discrete Stokes equations without forces have one solution, and the rigid motion is it. So multipliers grow with
//! the surface, not the volume, and the answer is the same to the last digit; with inertia too, as the force inside is that of the
//! rigid motion.

use std::rc::Rc;

use super::{
    LATTICE_BYTES,
    body::AdjointBody,
    equations::{Equations, RowEquations, UnitInverse},
    inertia::AdjointMethod,
    nodes::{AdjointNodes, Collector, within_walls},
    rigid::{motions, push_readings},
};
use crate::{
    constraint::{
        body::BodyBlocks,
        index_box::IndexBox,
        method::{Method, Size},
        placed::{Placed, Surrounded},
        unknowns::Unknowns,
    },
    geometry::Ball,
    grid::{Grid, Index, stencil::moved},
    linalg::SparseRows,
};

/// The method.
#[derive(Debug, Clone, Copy, Default)]
pub struct Distributed {
    /// Of the operator of the fluid; 0 without inertia.
    pub shift: f64,
}

impl<const D: usize> Method<D, Box<dyn BodyBlocks<D>>> for Distributed {
    fn description(&self) -> String {
        "multipliers at the outermost points inside (distributed)".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        bodies.iter().map(|body| Box::new(self.body(grid, body.placed)) as Box<_>).collect()
    }

    fn bytes(&self, _grid: &Grid<D>, size: &Size<D>) -> f64 {
        LATTICE_BYTES * size.count as f64
    }

    fn count(&self, grid: &Grid<D>, ball: &Ball<D>, _modes: usize) -> usize {
        D * (D + 1) / 2 + layer(grid, ball).count()
    }

    fn on_surfaces(&self) -> bool {
        false
    }
}

impl<const D: usize> AdjointMethod<D> for Distributed {
    fn body(&self, grid: &Grid<D>, placed: &Placed<D>) -> AdjointBody<D> {
        assemble(grid, placed, self.shift)
    }
}

/// The blocks of one body.
fn assemble<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, shift: f64) -> AdjointBody<D> {
    let (nodes, surface) = (layer(grid, &placed.ball()), &placed.surface);
    let (motions, cell, spacing) = (motions(surface, &nodes), grid.spacing().product(), grid.mean_spacing());
    let mut rows = SparseRows::default();
    push_readings(&motions, &vec![1.0; nodes.count()], &mut rows);
    // so that the residual is a mean over the surface
    let weight = (spacing / surface.modes.radius()).powf(0.5 * (D as f64 - 1.0));
    (0..nodes.count() as u32).for_each(|node| rows.push([(node, weight)]));
    let equations = RowEquations {
        rigid: motions.ncols(),
        motions: motions * weight,
        // a force at one point moves it by about a third of the square of the spacing, with inertia by less than one over the shift
        strengths: [surface.modes.force_factor() / cell, (2.0 / spacing.powi(2) + shift) / weight.powi(2)],
        compliance: Vec::new(),
        others: nodes.count(),
        inverse: Rc::new(UnitInverse),
    };
    AdjointBody { nodes, rows, wall_values: Vec::new(), equations: Equations::Rows(equations), cell, interior: None }
}

/// The points inside a ball with a neighbour outside.
fn layer<const D: usize>(grid: &Grid<D>, ball: &Ball<D>) -> AdjointNodes<D> {
    let mut collector = Collector::new(grid, Unknowns::Fluid, ball.center);
    for component in 0..D {
        for index in IndexBox::around(grid, component, &ball.center, ball.radius).indices() {
            if on_layer(grid, ball, component, index) {
                collector.node(component, index);
            }
        }
    }
    collector.nodes
}

fn on_layer<const D: usize>(grid: &Grid<D>, ball: &Ball<D>, component: usize, index: Index<D>) -> bool {
    let within = |index: Index<D>| (grid.position(component, index) - ball.center).norm_squared() <= ball.radius.powi(2);
    let inside = |index: Index<D>| within_walls(grid, component, index) && within(index);
    let mut neighbours = (0..D).flat_map(|axis| [-1, 1].map(|side| moved(index, axis, side)));
    inside(index) && !neighbours.all(inside)
}
