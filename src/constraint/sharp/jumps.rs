//! Jump functions of all modes of a body at chosen nodes.

use super::{Placed, nodes::Nodes};
use crate::constraint::dense::add_rows;

const EMPTY: u32 = u32::MAX;

/// Jump functions on the lattice of one field, at those nodes for which they were asked.
pub struct Jumps {
    count: usize,
    /// For each node, its row in `values`.
    rows: Vec<u32>,
    chosen: Vec<u32>,
    values: Vec<f64>,
}

impl Jumps {
    /// Those of a body at none of the nodes.
    pub fn new<const D: usize>(placed: &Placed<D>, nodes: &Nodes<D>) -> Jumps {
        let count = placed.surface.modes.count();
        Jumps { count, rows: vec![EMPTY; nodes.patch.len()], chosen: Vec::new(), values: Vec::new() }
    }

    /// Forgets all nodes, and turns to another body.
    pub fn turn_to<const D: usize>(&mut self, placed: &Placed<D>) {
        self.count = placed.surface.modes.count();
        self.chosen.drain(..).for_each(|place| self.rows[place as usize] = EMPTY);
    }

    /// Asks for the node at a place; returns its row.
    pub fn choose(&mut self, place: usize) -> u32 {
        if self.rows[place] == EMPTY {
            self.rows[place] = self.chosen.len() as u32;
            self.chosen.push(place as u32);
        }
        self.rows[place]
    }

    /// The row of a node; senseless if it was not asked for.
    pub fn row(&self, place: usize) -> u32 {
        self.rows[place]
    }

    /// Whether a node was asked for.
    pub fn has(&self, place: usize) -> bool {
        self.rows[place] != EMPTY
    }

    /// Whether no node was asked for.
    pub fn is_empty(&self) -> bool {
        self.chosen.is_empty()
    }

    /// Number of modes.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Evaluates the jump functions of a body; velocities within `core` of its centre are zero.
    pub fn evaluate<const D: usize>(&mut self, nodes: &Nodes<D>, placed: &Placed<D>, core: f64) {
        let positions = self.chosen.iter().map(|&place| nodes.position(place as usize) - placed.center);
        let offsets: Vec<f64> = positions.flat_map(|offset| offset.data.0[0]).collect();
        self.values.resize(self.chosen.len() * self.count, 0.0);
        if nodes.field == D {
            placed.surface.modes.pressure_jumps(&offsets, &mut self.values);
            return;
        }
        placed.surface.modes.velocity_jumps(&offsets, nodes.field, &mut self.values);
        for (offset, values) in offsets.chunks_exact(D).zip(self.values.chunks_exact_mut(self.count)) {
            if offset.iter().map(|x| x * x).sum::<f64>() <= core * core {
                values.fill(0.0);
            }
        }
    }

    /// Adds to `out` a weighted sum of evaluated rows.
    pub fn add(&self, terms: &[(u32, f64)], out: &mut [f64]) {
        add_rows(terms, &self.values, out);
    }
}
