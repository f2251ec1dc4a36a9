//! The `sharp` method: surface multipliers, and stencils corrected for the jumps that they cause.
//!
//! A stencil `sum_j w_j q(x_j)` for a point on one side of a surface takes, from nodes on the other side, the smooth
//! extension of its own side. With the jump function `D` (outside minus inside) and `chi = 1` outside, 0 inside, this adds
//!
//! ```text
//! sum_j w_j (chi(x) - chi(x_j)) D(x_j)
//! ```
//!
//! which is linear in the multipliers and goes to the right-hand side: the matrices of the box stay as they are.
//! Velocities on a surface are interpolated from inside: a node outside the body counts with the inner extension `u - D`,
//! and a node inside another body first with the outer extension of that one. In the solution the inner extension is a
//! rigid motion, which interpolation reproduces; outer extensions `(a/r)^k` grow inwards so fast that interpolating them
//! turns high modes unstable where bodies crowd.

mod blocks;
mod jumps;
mod nodes;
mod passage;
mod sample;
mod spread;

use std::rc::Rc;

use nalgebra::SVector;

use super::dense::LocalBlock;
use crate::{geometry::Ball, grid::Grid, surface::SurfaceTable};
pub use blocks::{BodyBlocks, SharpBlocks, Situation};
use jumps::Jumps;
use nodes::Nodes;
pub use passage::{Passed, jump, passed};
use sample::{Interpolated, Sampling};
use spread::Spreading;

/// Lattice points around a surface that stencils and interpolation may touch, in spacings: next to walls it is one-sided.
const REACHES: [f64; 2] = [2.0, 3.0];

/// Jump functions are singular at the centre; closer than this (in spacings) they are taken as zero.
const CORE: f64 = 0.3;

/// Gap between two surfaces, in spacings, below which interpolation on one meets the inside of the other.
pub const INTERPOLATION_REACH: f64 = 3.5;

/// A body in its place.
#[derive(Clone)]
pub struct Placed<const D: usize> {
    /// Its centre, in the box or, for an image, beyond it.
    pub center: SVector<f64, D>,
    /// Its surface.
    pub surface: Rc<SurfaceTable<D>>,
}

impl<const D: usize> Placed<D> {
    /// It as a ball.
    pub fn ball(&self) -> Ball<D> {
        Ball { center: self.center, radius: self.surface.modes.radius() }
    }

    fn outside(&self, point: &SVector<f64, D>) -> bool {
        (point - self.center).norm_squared() > self.surface.modes.radius().powi(2)
    }
}

/// A neighbour whose inside may meet the interpolation on a body's surface: its number, and it in the image next to the body.
pub type Neighbour<const D: usize> = (usize, Placed<D>);

/// Memory that the assembly of one body after the other uses again.
#[derive(Default)]
pub struct Workspace {
    /// For each field, the jumps of the body.
    jumps: [Jumps; 4],
    /// For each component, the jumps of one neighbour after the other.
    of_neighbour: [Jumps; 3],
    interpolated: Interpolated,
    /// Values of the rows of bodies that are gone.
    values: Vec<Vec<f64>>,
}

impl Workspace {
    /// Takes the memory of blocks that are no longer needed.
    pub fn recycle<const D: usize>(&mut self, blocks: BodyBlocks<D>) {
        self.values.push(blocks.rows.values);
    }
}

/// The blocks of one body.
pub fn assemble<const D: usize>(
    grid: &Grid<D>,
    (body, placed): (usize, &Placed<D>),
    neighbours: &[Neighbour<D>],
    workspace: &mut Workspace,
) -> BodyBlocks<D> {
    let reach = placed.surface.modes.radius() + reach(grid);
    let nodes: Vec<Nodes<D>> = (0..=D).map(|field| Nodes::around(grid, field, placed, reach)).collect();
    let Workspace { jumps, of_neighbour, interpolated, values } = workspace;
    let (jumps, of_neighbour) = (&mut jumps[..=D], &mut of_neighbour[..D]);
    nodes.iter().zip(&mut *jumps).for_each(|(nodes, jumps)| jumps.turn_to(placed, nodes));
    let spreading = Spreading::new(grid, placed, &nodes, jumps);
    let sampling = Sampling::new(grid, placed, &nodes, jumps);
    let core = CORE * grid.spacing().max();
    nodes.iter().zip(&mut *jumps).for_each(|(nodes, jumps)| jumps.evaluate(nodes, placed, core));
    let own = sampling.own_block(jumps, interpolated).map(|block| (body, block));
    let others = neighbours.iter().filter_map(|(other, neighbour)| {
        let block = sampling.neighbour_block((neighbour, core), of_neighbour, interpolated)?;
        Some((*other, block))
    });
    let local = own.into_iter().chain(others);
    let (rows, on_walls) = spreading.rows(jumps, values.pop().unwrap_or_default());
    BodyBlocks {
        surface: placed.surface.clone(),
        situation: Situation::of((body, placed), neighbours),
        rows,
        on_walls,
        local: local.map(|(body, transposed)| LocalBlock { body, transposed }).collect(),
        interpolant: sampling.interpolant,
    }
}

/// How far from a surface, along each axis, stencils and interpolation reach.
fn reach<const D: usize>(grid: &Grid<D>) -> f64 {
    REACHES[usize::from(!grid.domain().fully_periodic())] * grid.spacing().max()
}
