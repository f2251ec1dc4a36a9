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

mod passage;
mod sample;
mod spread;

use std::rc::Rc;

use nalgebra::SVector;

use super::{Layout, blocks::BodyBlocks, patch::Patch};
use crate::{
    grid::{Grid, Index},
    surface::SurfaceTable,
};
pub use passage::{Passed, jump, passed};
use sample::Sampling;
use spread::Spreading;

/// Lattice points around a surface that stencils and interpolation may touch, in spacings.
const REACH: f64 = 4.0;

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
    fn outside(&self, point: &SVector<f64, D>) -> bool {
        (point - self.center).norm_squared() > self.surface.modes.radius().powi(2)
    }
}

/// A neighbour whose inside may meet the interpolation on a body's surface: its number, and it in the image next to the body.
pub type Neighbour<const D: usize> = (usize, Placed<D>);

/// The blocks of one body.
pub fn assemble<const D: usize>(
    grid: &Grid<D>,
    layout: &Layout,
    body: usize,
    placed: &Placed<D>,
    neighbours: &[Neighbour<D>],
) -> BodyBlocks<D> {
    let mut places = Places::around(grid, placed);
    let (spread_rows, spread_values) = Spreading::new(grid, placed).all_rows(&mut places);
    let sampling = Sampling::new(grid, placed, neighbours).all_points(&mut places);
    let others = std::iter::once(body).chain(neighbours.iter().map(|(other, _)| *other));
    BodyBlocks {
        surface: placed.surface.clone(),
        first: layout.local(body),
        places: places.fluid_indices,
        spread_rows,
        spread_values,
        local: sampling.local_blocks(others.map(|other| layout.global(other))),
        sample_ends: sampling.ends,
        sample_terms: sampling.terms,
        wall_values: sampling.wall_values,
    }
}

/// The lattice points that a body touches, each with a place of its own.
struct Places<const D: usize> {
    patches: Vec<Patch<D>>,
    fluid_indices: Vec<i32>,
}

impl<const D: usize> Places<D> {
    fn around(grid: &Grid<D>, placed: &Placed<D>) -> Places<D> {
        Places { patches: (0..=D).map(|field| patch(grid, placed, field)).collect(), fluid_indices: Vec::new() }
    }

    fn of(&mut self, field: usize, index: Index<D>, fluid_index: usize) -> u32 {
        let place = self.patches[field].find(index).unwrap_or_else(|| {
            self.patches[field].set(index, self.fluid_indices.len());
            self.fluid_indices.push(fluid_index as i32);
            self.fluid_indices.len() - 1
        });
        place as u32
    }
}

/// The lattice of a field around a body, as far as stencils and interpolation reach.
fn patch<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, field: usize) -> Patch<D> {
    Patch::around(grid, field, &placed.center, placed.surface.modes.radius() + REACH * grid.spacing().max())
}

/// One component of the velocity jump of all modes at a point.
fn velocity_jump<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, component: usize, position: &SVector<f64, D>, out: &mut [f64]) {
    let offset = position - placed.center;
    if offset.norm() > CORE * grid.spacing().max() {
        placed.surface.modes.velocity_jump(offset.as_slice(), component, out);
    }
}
