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
//! Velocities on a surface are interpolated from outside: a node inside any body counts with its outer extension `u + D`.

use std::rc::Rc;

use nalgebra::{DMatrix, SVector};

use super::{Layout, blocks::BodyBlocks, conservation::conserve_momentum, patch::Patch};
use crate::{
    grid::{
        Grid, Index, Node, interpolation,
        stencil::{self, Site, Term},
    },
    surface::SurfaceTable,
};

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
    let mut assembly = Assembly::new(grid, placed);
    for field in 0..=D {
        assembly.spread_field(field);
    }
    assembly.interpolate(neighbours);
    assembly.finish(layout, body, neighbours)
}

/// Jump functions on the lattice of one field, evaluated where first asked for.
struct Jumps<const D: usize> {
    patch: Patch<D>,
    values: Vec<f64>,
}

/// A lattice point that interpolation meets: its place, unless it lies on a wall, and the jumps of the bodies around it,
/// as (0 for the body itself or 1 + number of the neighbour, values of all its modes).
struct Met {
    place: Option<u32>,
    jumps: Vec<(usize, Vec<f64>)>,
}

struct Assembly<'a, const D: usize> {
    grid: &'a Grid<D>,
    placed: &'a Placed<D>,
    count: usize,
    jumps: Vec<Jumps<D>>,
    place_of: Vec<Patch<D>>,
    places: Vec<i32>,
    spread_rows: Vec<u32>,
    spread_values: Vec<f64>,
    sample_ends: Vec<u32>,
    sample_terms: Vec<(u32, f64)>,
    wall_values: Vec<f64>,
    /// For each component, the lattice points that interpolation meets, as numbers of `met`.
    met_at: Vec<Patch<D>>,
    met: Vec<Met>,
    /// For the body and its neighbours.
    interpolated_jumps: Vec<InterpolatedJumps>,
}

impl<'a, const D: usize> Assembly<'a, D> {
    fn new(grid: &'a Grid<D>, placed: &'a Placed<D>) -> Self {
        let reach = placed.surface.modes.radius() + REACH * grid.spacing().max();
        let patch = |field| Patch::around(grid, field, &placed.center, reach);
        Assembly {
            grid,
            placed,
            count: placed.surface.modes.count(),
            jumps: (0..=D).map(|field| Jumps { patch: patch(field), values: Vec::new() }).collect(),
            place_of: (0..=D).map(patch).collect(),
            places: Vec::new(),
            spread_rows: Vec::new(),
            spread_values: Vec::new(),
            sample_ends: Vec::new(),
            sample_terms: Vec::new(),
            wall_values: Vec::new(),
            met_at: (0..D).map(patch).collect(),
            met: Vec::new(),
            interpolated_jumps: Vec::new(),
        }
    }

    /// Rows of C of one field: momentum along an axis, or continuity.
    fn spread_field(&mut self, field: usize) {
        let (radius, reach) = (self.placed.surface.modes.radius(), self.grid.spacing().max());
        let (first_value, mut offsets) = (self.spread_values.len(), Vec::new());
        let mut row = vec![0.0; self.count];
        for index in self.place_of[field].indices() {
            let distance = (self.grid.position(field, index) - self.placed.center).norm() - radius;
            if distance.abs() > reach {
                continue;
            }
            let Node::Unknown(place) = self.grid.fluid_node(field, index) else { continue };
            let crossed = if field < D {
                self.momentum_row(field, index, distance > 0.0, &mut row)
            } else {
                self.continuity_row(index, distance > 0.0, &mut row)
            };
            if crossed {
                let slot = self.place(field, index, place);
                self.spread_rows.push(slot);
                offsets.push(self.grid.position(field, index) - self.placed.center);
                self.spread_values.append(&mut row);
                row.resize(self.count, 0.0);
            }
        }
        if field < D {
            let values = &mut self.spread_values[first_value..];
            conserve_momentum(field, &self.placed.surface, self.grid.spacing().product(), &offsets, values);
        }
    }

    fn momentum_row(&mut self, field: usize, index: Index<D>, outside: bool, row: &mut [f64]) -> bool {
        let grid = self.grid;
        let mut crossed = false;
        stencil::laplacian(grid, field, index, |term| crossed |= self.correct(field, term, outside, 1.0, row));
        for term in stencil::gradient(grid, field, index) {
            crossed |= self.correct(field, term, outside, -1.0, row);
        }
        crossed
    }

    fn continuity_row(&mut self, index: Index<D>, outside: bool, row: &mut [f64]) -> bool {
        let mut crossed = false;
        for axis in 0..D {
            for term in stencil::divergence(self.grid, axis, index) {
                crossed |= self.correct(D, term, outside, -1.0, row);
            }
        }
        crossed
    }

    /// Adds the correction of one term of a row of `field`, times `sign`, if it reaches across the surface; tells whether it does.
    fn correct(&mut self, field: usize, term: Term<D>, outside: bool, sign: f64, row: &mut [f64]) -> bool {
        let position = match term.site {
            Site::Lattice { field, index } => self.grid.position(field, index),
            Site::Wall { position, .. } => position,
        };
        if self.placed.outside(&position) == outside {
            return false;
        }
        let factor = if outside { sign * term.weight } else { -sign * term.weight };
        let mut add = |jump: &[f64]| row.iter_mut().zip(jump).for_each(|(row, jump)| *row += factor * jump);
        match term.site {
            Site::Lattice { field, index } => add(self.jumps[field].at(self.grid, self.placed, field, index)),
            Site::Wall { position, .. } => {
                let mut jump = vec![0.0; self.count];
                velocity_jump(self.grid, self.placed, field, &position, &mut jump);
                add(&jump);
            }
        }
        true
    }

    fn place(&mut self, field: usize, index: Index<D>, fluid_index: usize) -> u32 {
        let slot = self.place_of[field].find(index).unwrap_or_else(|| {
            self.place_of[field].set(index, self.places.len());
            self.places.push(fluid_index as i32);
            self.places.len() - 1
        });
        slot as u32
    }

    /// Interpolation on the surface, and the jumps of this body and its neighbours that it picks up inside them.
    fn interpolate(&mut self, neighbours: &[Neighbour<D>]) {
        let surface = &self.placed.surface;
        self.interpolated_jumps = (0..=neighbours.len()).map(|_| InterpolatedJumps::default()).collect();
        self.wall_values = vec![0.0; surface.points() * D];
        self.sample_terms.reserve(surface.points() * D * 4_usize.pow(D as u32));
        for (point, offset) in surface.offsets().enumerate() {
            for component in 0..D {
                let position = self.placed.center + offset;
                let row = point * D + component;
                let grid = self.grid;
                interpolation::velocity(grid, component, &position, |term| self.sample_term(row, component, term, neighbours));
                self.sample_ends.push(self.sample_terms.len() as u32);
            }
        }
    }

    fn sample_term(&mut self, row: usize, component: usize, term: Term<D>, neighbours: &[Neighbour<D>]) {
        let Site::Lattice { index, .. } = term.site else {
            if let Site::Wall { value, .. } = term.site {
                self.wall_values[row] += term.weight * value;
            }
            return;
        };
        let number = self.met_at[component].find(index).unwrap_or_else(|| self.meet(component, index, neighbours));
        let met = &self.met[number];
        if let Some(place) = met.place {
            self.sample_terms.push((place, term.weight));
        }
        for (slot, jump) in &met.jumps {
            self.interpolated_jumps[*slot].add(row, term.weight, jump);
        }
    }

    fn meet(&mut self, component: usize, index: Index<D>, neighbours: &[Neighbour<D>]) -> usize {
        let place = match self.grid.fluid_node(component, index) {
            Node::Unknown(place) => Some(self.place(component, index, place)),
            Node::Wall(_) => None,
        };
        let position = self.grid.position(component, index);
        let bodies = std::iter::once(self.placed).chain(neighbours.iter().map(|(_, neighbour)| neighbour));
        let around = bodies.enumerate().filter(|(_, body)| !body.outside(&position));
        let jump = |(slot, body): (usize, &Placed<D>)| {
            let mut jump = vec![0.0; body.surface.modes.count()];
            velocity_jump(self.grid, body, component, &position, &mut jump);
            (slot, jump)
        };
        let jumps = around.map(jump).collect();
        self.met_at[component].set(index, self.met.len());
        self.met.push(Met { place, jumps });
        self.met.len() - 1
    }

    fn finish(self, layout: &Layout, body: usize, neighbours: &[Neighbour<D>]) -> BodyBlocks<D> {
        let projector = self.placed.surface.projector();
        let others = std::iter::once(body).chain(neighbours.iter().map(|(other, _)| *other));
        let local = others
            .zip(self.interpolated_jumps)
            .filter(|(_, jumps)| !jumps.rows.is_empty())
            .map(|(other, jumps)| (layout.global(other), jumps.project(projector)))
            .collect();
        BodyBlocks {
            surface: self.placed.surface.clone(),
            first: layout.local(body),
            places: self.places,
            spread_rows: self.spread_rows,
            spread_values: self.spread_values,
            sample_ends: self.sample_ends,
            sample_terms: self.sample_terms,
            wall_values: self.wall_values,
            local,
        }
    }
}

/// Jumps of one body's modes interpolated at surface points: only the rows (point and component) that meet its inside.
#[derive(Default)]
struct InterpolatedJumps {
    rows: Vec<usize>,
    /// One value a mode for each of the rows.
    values: Vec<f64>,
}

impl InterpolatedJumps {
    /// Adds a term to a row; rows come in order.
    fn add(&mut self, row: usize, weight: f64, jump: &[f64]) {
        if self.rows.last() != Some(&row) {
            self.rows.push(row);
            self.values.resize(self.rows.len() * jump.len(), 0.0);
        }
        let start = self.values.len() - jump.len();
        self.values[start..].iter_mut().zip(jump).for_each(|(value, jump)| *value += weight * jump);
    }

    /// The block of E: modes of the surface down, modes of the body across.
    fn project(&self, projector: &DMatrix<f64>) -> DMatrix<f64> {
        let modes = self.values.len() / self.rows.len();
        let jumps = DMatrix::from_column_slice(modes, self.rows.len(), &self.values);
        projector.select_columns(&self.rows) * jumps.transpose()
    }
}

impl<const D: usize> Jumps<D> {
    /// The jump functions of all modes at a lattice point.
    fn at(&mut self, grid: &Grid<D>, placed: &Placed<D>, field: usize, index: Index<D>) -> &[f64] {
        let count = placed.surface.modes.count();
        let slot = self.patch.find(index).unwrap_or_else(|| {
            let slot = self.values.len() / count;
            self.patch.set(index, slot);
            self.values.resize((slot + 1) * count, 0.0);
            let position = grid.position(field, index);
            let out = &mut self.values[slot * count..];
            if field < D {
                velocity_jump(grid, placed, field, &position, out);
            } else {
                placed.surface.modes.pressure_jump((position - placed.center).as_slice(), out);
            }
            slot
        });
        &self.values[slot * count..][..count]
    }
}

fn velocity_jump<const D: usize>(grid: &Grid<D>, placed: &Placed<D>, component: usize, position: &SVector<f64, D>, out: &mut [f64]) {
    let offset = position - placed.center;
    if offset.norm() > CORE * grid.spacing().max() {
        placed.surface.modes.velocity_jump(offset.as_slice(), component, out);
    }
}
