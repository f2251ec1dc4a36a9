//! The blocks J and E: the velocity on a surface, interpolated from the inner extension.

use nalgebra::{DMatrix, SVector};

use super::{Neighbour, Placed, Places, patch, velocity_jump};
use crate::{
    constraint::patch::Patch,
    grid::{
        Grid, Index, Node, interpolation,
        stencil::{Site, Term},
    },
};

/// A lattice point that interpolation meets: its place, unless it lies on a wall, and the jumps of the bodies around it,
/// as (0 for the body itself or 1 + number of the neighbour, values of all its modes).
struct Met {
    place: Option<u32>,
    jumps: Vec<(usize, Vec<f64>)>,
}

/// The interpolation on one body's surface, under way.
pub struct Sampling<'a, const D: usize> {
    grid: &'a Grid<D>,
    placed: &'a Placed<D>,
    neighbours: &'a [Neighbour<D>],
    /// For each component of each point, where its terms end.
    pub ends: Vec<u32>,
    /// Place and weight.
    pub terms: Vec<(u32, f64)>,
    /// For each component of each point, what moving walls add.
    pub wall_values: Vec<f64>,
    /// For each component, the lattice points met, as numbers of `met`.
    met_at: Vec<Patch<D>>,
    met: Vec<Met>,
    /// For the body and its neighbours.
    interpolated_jumps: Vec<InterpolatedJumps>,
}

impl<'a, const D: usize> Sampling<'a, D> {
    /// Nothing yet.
    pub fn new(grid: &'a Grid<D>, placed: &'a Placed<D>, neighbours: &'a [Neighbour<D>]) -> Self {
        let rows = placed.surface.points() * D;
        Sampling {
            grid,
            placed,
            neighbours,
            ends: Vec::with_capacity(rows),
            terms: Vec::with_capacity(rows * 4_usize.pow(D as u32)),
            wall_values: vec![0.0; rows],
            met_at: (0..D).map(|component| patch(grid, placed, component)).collect(),
            met: Vec::new(),
            interpolated_jumps: (0..=neighbours.len()).map(|_| InterpolatedJumps::default()).collect(),
        }
    }

    /// Interpolates at all points of the surface.
    pub fn all_points(mut self, places: &mut Places<D>) -> Self {
        for (point, offset) in self.placed.surface.offsets().enumerate() {
            let position = self.placed.center + offset;
            for component in 0..D {
                let row = point * D + component;
                interpolation::velocity(self.grid, component, &position, |term| self.add(row, component, term, places));
                self.ends.push(self.terms.len() as u32);
            }
        }
        self
    }

    fn add(&mut self, row: usize, component: usize, term: Term<D>, places: &mut Places<D>) {
        let index = match term.site {
            Site::Lattice { index, .. } => index,
            Site::Wall { value, position } => {
                self.wall_values[row] += term.weight * value;
                let jump = self.extension(0, self.placed, component, &position);
                return jump.into_iter().for_each(|(slot, jump)| self.interpolated_jumps[slot].add(row, term.weight, &jump));
            }
        };
        let number = self.met_at[component].find(index).unwrap_or_else(|| self.meet(component, index, places));
        let met = &self.met[number];
        if let Some(place) = met.place {
            self.terms.push((place, term.weight));
        }
        for (slot, jump) in &met.jumps {
            self.interpolated_jumps[*slot].add(row, term.weight, jump);
        }
    }

    fn meet(&mut self, component: usize, index: Index<D>, places: &mut Places<D>) -> usize {
        let place = match self.grid.fluid_node(component, index) {
            Node::Unknown(unknown) => Some(places.of(component, index, unknown)),
            Node::Wall(_) => None,
        };
        let position = self.grid.position(component, index);
        let bodies = std::iter::once(self.placed).chain(self.neighbours.iter().map(|(_, neighbour)| neighbour));
        let jumps = bodies.enumerate().filter_map(|(slot, body)| self.extension(slot, body, component, &position)).collect();
        self.met_at[component].set(index, self.met.len());
        self.met.push(Met { place, jumps });
        self.met.len() - 1
    }

    /// What turns the velocity at a point into that of the inside of the body itself (slot 0) or of the outside of a neighbour.
    fn extension(&self, slot: usize, body: &Placed<D>, component: usize, position: &SVector<f64, D>) -> Option<(usize, Vec<f64>)> {
        if body.outside(position) != (slot == 0) {
            return None;
        }
        let mut jump = vec![0.0; body.surface.modes.count()];
        velocity_jump(self.grid, body, component, position, &mut jump);
        if slot == 0 {
            jump.iter_mut().for_each(|jump| *jump = -*jump);
        }
        Some((slot, jump))
    }

    /// The dense blocks of E, each with the first multiplier of its columns; `firsts` are those of the body and its neighbours.
    pub fn local_blocks(&self, firsts: impl Iterator<Item = usize>) -> Vec<(usize, DMatrix<f64>)> {
        let projector = self.placed.surface.projector();
        let met = firsts.zip(&self.interpolated_jumps).filter(|(_, jumps)| !jumps.rows.is_empty());
        met.map(|(first, jumps)| (first, jumps.project(projector))).collect()
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
