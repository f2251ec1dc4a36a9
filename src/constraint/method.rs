//! What a way to make bodies rigid on a grid that ignores them has to do.

use super::{body::BodyBlocks, placed::Surrounded};
use crate::{geometry::Ball, grid::Grid};

/// A method for a problem whose bodies have blocks `B`.
pub trait Method<const D: usize, B> {
    /// What is built, in the words of a plan.
    fn description(&self) -> String;

    /// The blocks of bodies in their places; `memory` may be used again.
    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], memory: Vec<Vec<f32>>) -> Vec<B>;

    /// Bytes that the blocks of one body take, about.
    fn bytes(&self, grid: &Grid<D>, size: &Size<D>) -> f64;

    /// Number of multipliers of a body with so many modes.
    fn count(&self, _grid: &Grid<D>, _ball: &Ball<D>, modes: usize) -> usize {
        modes
    }

    /// Whether multipliers are coefficients of the surface modes, as many whatever the body's place.
    fn on_surfaces(&self) -> bool {
        true
    }

    /// Whether jump functions of the multipliers extend the flow outside a body smoothly into it.
    fn jumps(&self) -> bool {
        false
    }

    /// The gap, in spacings, below which a neighbour has a part in the blocks of a body.
    fn reach(&self) -> f64 {
        0.0
    }
}

/// How large the blocks of a body are.
#[derive(Debug, Clone, Copy)]
pub struct Size<const D: usize> {
    /// The body.
    pub ball: Ball<D>,
    /// Highest order of its modes.
    pub order: usize,
    /// Number of its multipliers.
    pub count: usize,
}

/// A method for bodies in a fluid.
pub type FlowMethod<const D: usize> = dyn Method<D, Box<dyn BodyBlocks<D>>>;
