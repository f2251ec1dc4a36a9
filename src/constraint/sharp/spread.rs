//! The block C: stencils that cross a surface, corrected for the jumps there.

use super::{Placed, Places, patch, velocity_jump};
use crate::{
    constraint::{conservation::conserve_momentum, patch::Patch},
    grid::{
        Grid, Index, Node,
        stencil::{self, Site, Term},
    },
};

/// Jump functions on the lattice of one field, evaluated where first asked for.
struct Jumps<const D: usize> {
    patch: Patch<D>,
    values: Vec<f64>,
}

/// The rows of C of one body, under way.
pub struct Spreading<'a, const D: usize> {
    grid: &'a Grid<D>,
    placed: &'a Placed<D>,
    count: usize,
    jumps: Vec<Jumps<D>>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl<'a, const D: usize> Spreading<'a, D> {
    /// Nothing yet.
    pub fn new(grid: &'a Grid<D>, placed: &'a Placed<D>) -> Self {
        let jumps = (0..=D).map(|field| Jumps { patch: patch(grid, placed, field), values: Vec::new() }).collect();
        Spreading { grid, placed, count: placed.surface.modes.count(), jumps, rows: Vec::new(), values: Vec::new() }
    }

    /// All rows: their places, and one value a mode for each.
    pub fn all_rows(mut self, places: &mut Places<D>) -> (Vec<u32>, Vec<f64>) {
        for field in 0..=D {
            self.rows_of(field, places);
        }
        (self.rows, self.values)
    }

    /// Rows of C of one field: momentum along an axis, or continuity.
    fn rows_of(&mut self, field: usize, places: &mut Places<D>) {
        let (radius, reach) = (self.placed.surface.modes.radius(), self.grid.spacing().max());
        let (first_value, mut offsets) = (self.values.len(), Vec::new());
        let mut row = vec![0.0; self.count];
        for index in places.patches[field].indices() {
            let offset = self.grid.position(field, index) - self.placed.center;
            let distance = offset.norm() - radius;
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
                self.rows.push(places.of(field, index, place));
                offsets.push(offset);
                self.values.append(&mut row);
                row.resize(self.count, 0.0);
            }
        }
        if field < D {
            let values = &mut self.values[first_value..];
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
