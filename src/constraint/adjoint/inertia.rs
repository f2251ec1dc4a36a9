//! Methods that spread by the adjoint, for bodies with inertia.
//!
//! The flow is carried along everywhere as if there were no bodies, and rigidity acts on what comes of it: so momentum of box and bodies together is
//! conserved. An [`InteriorForce`], at each point as much of it as of its cell is inside, lets the fluid inside spin up with the body.

use super::body::AdjointBody;
use crate::{
    constraint::{
        body::BodyBlocks,
        index_box::IndexBox,
        interior::InteriorForce,
        method::{Method, Size},
        placed::{Placed, Surrounded},
        unknowns::Unknowns,
    },
    geometry::{Ball, fraction},
    grid::Grid,
};

/// A method whose multipliers act where its rows look.
pub trait AdjointMethod<const D: usize>: Method<D, Box<dyn BodyBlocks<D>>> {
    /// The blocks of one body without inertia.
    fn body(&self, grid: &Grid<D>, placed: &Placed<D>) -> AdjointBody<D>;
}

/// Such a method for bodies with inertia.
#[derive(Debug, Clone)]
pub struct AdjointWithInertia<M> {
    /// The method.
    pub method: M,
    /// For each body, the spin-up `rho w' / mu` that a unit multiplier of rotation gives it; zero for prescribed motion.
    pub spin_up_of: Vec<f64>,
}

impl<const D: usize, M: AdjointMethod<D>> Method<D, Box<dyn BodyBlocks<D>>> for AdjointWithInertia<M> {
    fn description(&self) -> String {
        format!("{}, bodies with inertia", self.method.description())
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], _memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        let of = |body: &Surrounded<D>| -> Box<dyn BodyBlocks<D>> {
            let interior = Some(interior_force(grid, &body.placed.ball(), self.spin_up_of[body.body]));
            Box::new(AdjointBody { interior, ..self.method.body(grid, body.placed) })
        };
        bodies.iter().map(of).collect()
    }

    fn bytes(&self, grid: &Grid<D>, size: &Size<D>) -> f64 {
        self.method.bytes(grid, size)
    }

    fn count(&self, grid: &Grid<D>, ball: &Ball<D>, modes: usize) -> usize {
        self.method.count(grid, ball, modes)
    }

    fn on_surfaces(&self) -> bool {
        self.method.on_surfaces()
    }

    fn reach(&self) -> f64 {
        self.method.reach()
    }
}

/// The force inside a ball.
fn interior_force<const D: usize>(grid: &Grid<D>, ball: &Ball<D>, factor: f64) -> InteriorForce {
    let (mut force, spacing) = (InteriorForce::new(factor), grid.spacing());
    for component in 0..D {
        for index in IndexBox::around(grid, component, &ball.center, ball.radius + spacing.max()).indices() {
            let position = grid.position(component, index);
            let part = fraction(ball, &position, &spacing);
            if let (true, Some(unknown)) = (part > 0.0, Unknowns::Fluid.at(grid, component, index)) {
                force.push(unknown, component, &(position - ball.center), part);
            }
        }
    }
    force
}
