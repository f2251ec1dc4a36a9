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

mod body;
mod cleared;
mod interpolate;
mod jumps;
mod nodes;
mod spinning;
mod spread;

use super::{
    body::BodyBlocks,
    conservation::TERMS,
    dense::{KeptBlock, LocalBlock},
    kept_values::{KeptValues, Precision},
    method::{Method, Size},
    placed::Surrounded,
    rows::{KeptRows, Rows},
    unknowns::Unknowns,
};
use crate::{grid::Grid, surface::SurfaceTable};
pub use body::SharpBody;
pub use cleared::{FreshlyCleared, freshly_cleared, jump};
use interpolate::{Interpolated, Interpolation};
use jumps::Jumps;
pub use nodes::JumpNodes;
use nodes::reach;
pub use spinning::SharpWithInertia;
use spread::Spreading;

/// Jump functions are singular at the centre; closer than this (in spacings) they are taken as zero.
const CORE: f64 = 0.3;

/// Gap between two surfaces, in spacings, below which interpolation on one meets the inside of the other.
pub const INTERPOLATION_REACH: f64 = 3.5;

/// Dense blocks of E that a body has in a dense suspension: its own and those of neighbours.
const LOCAL_BLOCKS: f64 = 7.0;

/// Memory that the assembly of one body after the other uses again.
pub struct Workspace {
    /// How exactly rows are kept.
    precision: Precision,
    /// For each field, the jumps of the body.
    jumps: [Jumps; 4],
    /// For each component, the jumps of one neighbour after the other.
    of_neighbour: [Jumps; 3],
    interpolated: Interpolated,
    /// Values of the rows of one body after the other.
    values: Vec<f64>,
    /// Those, as they were kept, of bodies that are gone.
    kept: Vec<Vec<f32>>,
}

impl Workspace {
    /// Rows are kept so exactly, in this memory.
    pub fn new(precision: Precision, kept: Vec<Vec<f32>>) -> Workspace {
        let (jumps, of_neighbour, interpolated) = Default::default();
        Workspace { precision, jumps, of_neighbour, interpolated, values: Vec::new(), kept }
    }
}

/// A body without its blocks and rows, these in double precision, and the nodes of each field.
pub struct AssembledBody<const D: usize> {
    /// The body.
    pub body: SharpBody<D>,
    /// Its rows, with values of sources behind those of the modes.
    pub rows: Rows,
    /// Dense blocks of E.
    pub local: Vec<LocalBlock>,
    /// Where the rows of each field end.
    pub field_ends: Vec<usize>,
    /// The nodes.
    pub nodes: Vec<JumpNodes<D>>,
}

impl<const D: usize> AssembledBody<D> {
    /// The body with its blocks and rows, as they are kept.
    pub fn kept(self, workspace: &mut Workspace) -> SharpBody<D> {
        let AssembledBody { body, local, rows, field_ends, .. } = self;
        let (count, precision) = (body.surface.modes.count(), workspace.precision);
        let kept = KeptValues::of_rows(&rows.values, count, &field_ends, precision, &mut workspace.kept);
        let (rows, values) = rows.with_values(kept);
        workspace.values = values;
        SharpBody { rows, local: local.into_iter().map(|block| KeptBlock::new(block, precision)).collect(), ..body }
    }
}

/// The method.
#[derive(Debug, Clone, Copy)]
pub struct Sharp {
    /// How exactly rows are kept.
    pub precision: Precision,
}

impl<const D: usize> Method<D, Box<dyn BodyBlocks<D>>> for Sharp {
    fn description(&self) -> String {
        "surface multipliers with corrected stencils (sharp)".into()
    }

    fn assemble(&self, grid: &Grid<D>, bodies: &[Surrounded<D>], memory: Vec<Vec<f32>>) -> Vec<Box<dyn BodyBlocks<D>>> {
        let mut workspace = Workspace::new(self.precision, memory);
        workspace.interpolated.at_points = true;
        let of = |body: &Surrounded<D>| -> Box<dyn BodyBlocks<D>> {
            Box::new(assemble(grid, body, &mut workspace, |_| vec![Vec::new(); D]).kept(&mut workspace))
        };
        bodies.iter().map(of).collect()
    }

    fn bytes(&self, grid: &Grid<D>, size: &Size<D>) -> f64 {
        bytes(grid, size, self.precision)
    }

    fn reach(&self) -> f64 {
        INTERPOLATION_REACH
    }

    fn jumps(&self) -> bool {
        true
    }
}

/// Values of the spread rows, weights and corners of interpolation, and the dense blocks.
pub fn bytes<const D: usize>(grid: &Grid<D>, Size { ball, order, count }: &Size<D>, precision: Precision) -> f64 {
    let (count, cells) = (*count as f64, ball.radius / grid.mean_spacing());
    let surface = if D == 2 { 2.0 * std::f64::consts::PI * cells } else { 4.0 * std::f64::consts::PI * cells * cells };
    let points = SurfaceTable::<D>::point_count(ball.radius, *order, grid.mean_spacing()) as f64;
    let rows = count * 2.0 * (D + 1) as f64 * surface;
    precision.bytes() * (rows + LOCAL_BLOCKS * count * count) + points * D as f64 * 20.0
}

/// The blocks of one body, with values of sources behind those of the modes that have the moments of `sources` in each component.
pub fn assemble<const D: usize>(
    grid: &Grid<D>,
    Surrounded { body, placed, neighbours }: &Surrounded<D>,
    workspace: &mut Workspace,
    sources: impl Fn(&[JumpNodes<D>]) -> Vec<Vec<[f64; TERMS]>>,
) -> AssembledBody<D> {
    let unknowns = Unknowns::of(placed.surface.modes.as_ref());
    let (fields, components) = (unknowns.fields::<D>(), unknowns.components::<D>());
    let reach = placed.ball().radius + reach(grid);
    let nodes: Vec<JumpNodes<D>> = (0..fields).map(|field| JumpNodes::around(grid, field, placed, reach)).collect();
    let Workspace { jumps, of_neighbour, interpolated, values, .. } = workspace;
    let (jumps, of_neighbour) = (&mut jumps[..fields], &mut of_neighbour[..components]);
    nodes.iter().zip(&mut *jumps).for_each(|(nodes, jumps)| jumps.turn_to(placed, nodes));
    let spreading = Spreading::new(grid, placed, &nodes, jumps);
    let interpolation = Interpolation::new(grid, placed, &nodes, jumps);
    let core = CORE * grid.spacing().max();
    nodes.iter().zip(&mut *jumps).for_each(|(nodes, jumps)| jumps.evaluate(nodes, placed, core));
    let own = interpolation.own_block(*body, jumps, interpolated);
    let others = neighbours.iter().filter_map(|neighbour| interpolation.neighbour_block(neighbour, core, of_neighbour, interpolated));
    let local = own.into_iter().chain(others).collect();
    let field_ends = spreading.field_ends();
    let (rows, on_walls) = spreading.rows(jumps, &sources(&nodes), std::mem::take(values));
    let body = SharpBody {
        surface: placed.surface.clone(),
        rows: KeptRows::default(),
        on_walls,
        local: Vec::new(),
        local_places: Vec::new(),
        interpolant: interpolation.interpolant,
    };
    AssembledBody { body, local, rows, field_ends, nodes }
}
